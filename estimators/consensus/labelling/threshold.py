"""Labels by threshold: an inlier is a point with |r| <= T (METHODS.md 13.21, inclusive everywhere)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from estimators.arrays import BoolArray, FloatArray


@dataclass(frozen=True, slots=True)
class Threshold:
    """The labeler of every preset so far."""

    def labels(self, residual: FloatArray, threshold: float) -> BoolArray:
        """Flag the inliers among whitened residuals, shape (n,).

        Examples
        --------
        >>> Threshold().labels(np.array([0.5, -1.0, 1.5]), 1.0)
        array([ True,  True, False])
        """
        return np.abs(residual) <= threshold
