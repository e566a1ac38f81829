"""exp(-z) from a table: a mixture takes three of them per reading and step."""

from __future__ import annotations

import numpy as np

from estimators.kernels import device

_DECAY_CELLS = 16
_DECAY_REACH = 44
_DECAY = np.exp(-np.arange(_DECAY_CELLS * _DECAY_REACH + 1) / _DECAY_CELLS)


@device
def decay(z: float) -> float:
    """exp(-z) for z >= 0, to a relative 1e-6 and at least 1e-19: enough to weigh structures, and fast."""
    x = min(z, _DECAY_REACH - 1e-9) * _DECAY_CELLS
    k = int(x)
    f = (x - k) * (1.0 / _DECAY_CELLS)
    return float(_DECAY[k]) * (1.0 - f * (1.0 - f * (0.5 - f * (1.0 / 6.0))))
