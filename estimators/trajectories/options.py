"""What a caller may set about tracks, besides the data."""

from __future__ import annotations

import math
from dataclasses import dataclass

from estimators.arrays import InputError


@dataclass(frozen=True, slots=True)
class TrackOptions:
    """Settings of cleaning; none of them is needed.

    Attributes
    ----------
    sigma_m : float or None
        Standard deviation of a good fix, per axis; default: estimated.
    max_speed_mps : float or None
        What moves faster is a fault; default: no limit, and 50 m/s for the method ``speed-gate``, the value
        customary in studies of cleaners.

    Raises
    ------
    InputError
        If a number is not positive.

    Examples
    --------
    >>> TrackOptions(max_speed_mps=15.0).sigma_m is None
    True
    """

    sigma_m: float | None = None
    max_speed_mps: float | None = None

    def __post_init__(self) -> None:
        for name, most in (("sigma_m", 1e4), ("max_speed_mps", 1e6)):
            value = getattr(self, name)
            if value is None:
                continue
            if isinstance(value, bool) or not (math.isfinite(value) and 0.0 < value <= most):
                raise InputError(f"options.{name}", f"must be a positive number, at most {most:g}")
            if name == "sigma_m" and value < 1e-3:
                raise InputError("options.sigma_m", "must be at least a millimetre, 0.001")
