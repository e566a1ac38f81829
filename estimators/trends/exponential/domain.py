"""The two kinds of noise an exponential can have, and how an answer came to one of them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal

NoiseDomain = Literal["multiplicative", "additive"]
NoiseSelection = Literal["given", "selected", "undetermined", "method"]

NOISE_CHOICES: Mapping[str, str] = MappingProxyType(
    {
        "auto": "told from the data",
        "multiplicative": "a share of the level, as of growth that varies",
        "additive": "the same at every level, as of an instrument",
    }
)
"""What callers pass as ``noise``, and what it means."""


@dataclass(frozen=True, slots=True)
class Noise:
    """In which domain the readings scatter about the trend.

    Attributes
    ----------
    domain : {"multiplicative", "additive"}
        ``multiplicative``: the scatter is a share of the level; sigma, threshold and residuals are those of
        ln(value). ``additive``: the scatter is the same at every level, in units of the values.
    selection : {"given", "selected", "undetermined", "method"}
        Asked for by the caller; told from the data; the data prefer neither (the other answer is the trend's
        ``alternative``); or the only one the method knows.
    margin : float or None
        Log evidence by which the data prefer ``domain``; None where the other was not weighed.
    """

    domain: NoiseDomain
    selection: NoiseSelection
    margin: float | None = None


_ASKED_FOR: Mapping[NoiseSelection, str] = {
    "given": "as asked for",
    "method": "all that this method knows",
    "undetermined": "undetermined: the data prefer neither",
    "selected": "told from the data",
}
_MOST_MARGIN = math.log(1e6)
"""Beyond it odds are a figure of speech."""


def noise_sentence(noise: Noise) -> str:
    """Say in a sentence what the noise is and how that was found.

    Examples
    --------
    >>> noise_sentence(Noise("additive", "selected", 4.0))
    'additive noise, the same at every level; told from the data (55 to 1)'
    """
    kind = (
        "multiplicative noise, a share of the level; sigma is that of ln(value)"
        if noise.domain == "multiplicative"
        else "additive noise, the same at every level"
    )
    text = f"{kind}; {_ASKED_FOR[noise.selection]}"
    if noise.margin is None or noise.margin <= 0.0:
        return text
    said = "over a million"
    if noise.margin < _MOST_MARGIN:
        said = f"{float(f'{math.exp(noise.margin):.2g}'):,.6g}"
    return f"{text} ({said} to 1)"
