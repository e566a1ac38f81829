"""The truncated quadratic: MSAC (Torr & Zisserman 2000; METHODS.md 3.1), truncated at T itself."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from estimators.arrays import FloatArray
from estimators.consensus.scan import MSAC


@dataclass(frozen=True, slots=True)
class Msac:
    """Loss (r / T)^2 for inliers, 1 for the rest: equal counts are told apart by how well they fit."""

    code: ClassVar[int] = MSAC

    def rho(self, u: FloatArray) -> FloatArray:
        """Loss of points with u = (r / T)^2: min(u, 1)."""
        return np.minimum(u, 1.0)
