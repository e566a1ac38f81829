"""Files of satellite navigation as text: plain, gzip or Hatanaka-compressed, told by their content.

What is unpacked is bounded, so that a small upload cannot fill the memory: :data:`MOST_BYTES`.
"""

from __future__ import annotations

import zlib
from pathlib import Path

from estimators.arrays import InputError

Source = bytes | Path
"""A file by its content or by its path."""

MOST_BYTES = 1 << 30
"""Unpacked size that is read: an hour of observations at 50 Hz, a day at 1 Hz of about 30 satellites."""
_GZIP, _COMPRESS = b"\x1f\x8b", b"\x1f\x9d"
_PIECE = 1 << 20


def read_text(source: Source, field: str, most_bytes: int = MOST_BYTES) -> str:
    """Read a file, unpack gzip, and decode it.

    Parameters
    ----------
    source : bytes or Path
    field : str
        Name used in errors.
    most_bytes : int
        Unpacked size above which the file is refused.

    Raises
    ------
    InputError
        If it cannot be read, is empty, is damaged, is no text, or is too large.

    Examples
    --------
    >>> import gzip
    >>> read_text(gzip.compress(b"G01"), "navigation")
    'G01'
    """
    content = _read(source, field)
    if content[:2] == _COMPRESS:
        raise InputError(field, "is packed by compress (.Z); unpack it, or pack it by gzip")
    if content[:2] == _GZIP:
        content = _gunzip(content, field, most_bytes)
    if len(content) > most_bytes:
        raise InputError(field, f"has more than {most_bytes} bytes; split it by time")
    if not content.strip():
        raise InputError(field, "is empty")
    if b"\x00" in content[:4096]:
        raise InputError(field, "is no text; send a plain, gzip or Hatanaka-compressed file")
    # Comments come in any encoding; numbers are ASCII.
    return content.decode("latin-1").replace("\r\n", "\n")


def _read(source: Source, field: str) -> bytes:
    if isinstance(source, Path):
        try:
            return source.read_bytes()
        except OSError as error:
            raise InputError(field, f"cannot be read: {error.strerror or type(error).__name__}") from error
    if not isinstance(source, bytes):
        raise InputError(field, "expected the bytes of a file or a pathlib.Path")
    return source


def _gunzip(packed: bytes, field: str, most_bytes: int) -> bytes:
    parts: list[bytes] = []
    size = 0
    rest = packed
    while rest.startswith(_GZIP):
        member = zlib.decompressobj(16 + zlib.MAX_WBITS)
        while not member.eof:
            try:
                part = member.decompress(rest, _PIECE)
            except zlib.error as error:
                raise InputError(field, "is a damaged gzip file; send it again") from error
            rest = member.unconsumed_tail
            size += len(part)
            parts.append(part)
            if size > most_bytes:
                raise InputError(field, f"unpacks to more than {most_bytes} bytes; split it by time")
            if not part and not rest and not member.eof:
                raise InputError(field, "is a gzip file that ends too early; send it again")
        rest = member.unused_data
    return b"".join(parts)
