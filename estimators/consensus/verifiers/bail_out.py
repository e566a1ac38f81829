"""Bail-out (Capel 2005; METHODS.md 5.4): stop valuing a model once it cannot beat the best any more.

Losses are sums of terms that are never negative, so a partial loss above the best complete one decides. The
partial sums are those of the score itself, chunk by chunk; survivors come out equal to the bit.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar


@dataclass(frozen=True, slots=True)
class BailOut:
    """Verification that refuses as early as is lossless."""

    lossless: ClassVar[bool] = True
    code: ClassVar[int] = 1

    def bound(self, best_loss: float) -> float:
        """Partial losses above the best complete loss are refused."""
        return best_loss
