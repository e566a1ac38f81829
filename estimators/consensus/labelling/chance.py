"""What a structure gains by having been looked for: the best of many lines fits even clean noise."""

from __future__ import annotations

from estimators.kernels import device

_SEARCHED = 0.7
_SEARCHED_FEW = 1.1
"""What the best of all structures gains on clean noise by having been searched for, per coefficient.

It gains more the fewer readings it holds, since there are more few-point structures to choose from: at one
price for all shares, a tenth of clean series of 50 points were taken for a line of less than a third of them.
The two numbers are a compromise: higher ones turn down real structures of 10 points in 50, and the four
giants of the star cluster CYG OB1 (Rousseeuw and Leroy 1987), which plain least squares follows.
"""


@device
def gain_of_search(coefficients: int, followers: float, n: float) -> float:
    """Log evidence that the best structure gains on n readings of clean noise."""
    return coefficients * (_SEARCHED + _SEARCHED_FEW * (1.0 - followers / n))
