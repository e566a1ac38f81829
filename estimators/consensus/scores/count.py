"""The number of inliers: RANSAC's own score (Fischler & Bolles 1981)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from estimators.arrays import FloatArray
from estimators.consensus.scan import COUNT


@dataclass(frozen=True, slots=True)
class Count:
    """Loss 1 for every point outside the threshold."""

    code: ClassVar[int] = COUNT

    def rho(self, u: FloatArray) -> FloatArray:
        """Loss of points with u = (r / T)^2: 0 for u <= 1, else 1."""
        return np.where(u <= 1.0, 0.0, 1.0)
