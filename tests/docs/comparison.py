"""Whether two outputs say the same: words must be equal, numbers nearly so, spacing does not matter."""

from __future__ import annotations

import re

_NUMBER = re.compile(r"[-+−]?(?:\d+\.\d*|\.\d+|\d+)(?:[eE][-+]?\d+)?")
_RULES = re.compile(r"[─━═—-]{2,}")
_ESCAPES = re.compile(r"\x1b\[[0-9;]*[A-Za-z]")

RELATIVE = 1e-3
LAST_DIGITS = 2


def tidy(output: str) -> str:
    """Output without terminal colours, trailing blanks and blank ends."""
    plain = _ESCAPES.sub("", output).replace("\r\n", "\n")
    return "\n".join(line.rstrip() for line in plain.split("\n")).strip("\n")


def difference(expected: str, actual: str) -> str | None:
    """What differs first, in words, or None where both say the same.

    Numbers agree when they differ by no more than 0.1 % or two units of the last printed digit.
    """
    left, right = _tokens(expected), _tokens(actual)
    for wanted, got in zip(left, right, strict=False):
        if wanted != got and not _same_number(wanted, got):
            return f"expected {wanted!r}, got {got!r}"
    if len(left) != len(right):
        more, name = (left, "missing") if len(left) > len(right) else (right, "unexpected")
        return f"{name}: {' '.join(more[min(len(left), len(right)) :][:12])!r}"
    return None


def _tokens(output: str) -> list[str]:
    """Numbers, and the words and signs between them."""
    plain = _RULES.sub(" ", tidy(output))
    tokens: list[str] = []
    place = 0
    for match in _NUMBER.finditer(plain):
        tokens.extend(plain[place : match.start()].split())
        tokens.append(match.group().replace("−", "-"))
        place = match.end()
    tokens.extend(plain[place:].split())
    return tokens


def _same_number(wanted: str, got: str) -> bool:
    if not (_NUMBER.fullmatch(wanted) and _NUMBER.fullmatch(got)):
        return False
    mantissa, _, exponent = wanted.lower().partition("e")
    decimals = len(mantissa.partition(".")[2])
    last_digit = 10.0 ** (int(exponent or 0) - decimals)
    # Counts are exact; only what was rounded may differ in its last digits.
    rounding = LAST_DIGITS * last_digit if decimals or exponent else 0.0
    a, b = float(wanted), float(got)
    return abs(a - b) <= max(rounding, RELATIVE * abs(a)) * (1 + 1e-9)
