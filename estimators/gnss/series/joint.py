"""What every joint solution gives, epoch by epoch in order of time and row by row: :class:`Joint`."""

from __future__ import annotations

from dataclasses import dataclass

from estimators.arrays import BoolArray, FloatArray


@dataclass(frozen=True, slots=True)
class Elsewhere:
    """A solution that competes.

    Attributes
    ----------
    first, last : int
        Epochs, in order of time, both included, to which it belongs.
    position_ecef_m : ndarray, shape (3,)
        At the epoch where it is farthest off.
    distance_m : float
        Horizontal, there.
    probability : float
    """

    first: int
    last: int
    position_ecef_m: FloatArray
    distance_m: float
    probability: float


@dataclass(frozen=True, slots=True)
class Joint:
    """A joint solution.

    Attributes
    ----------
    position_m, velocity_enu_mps : ndarray, shape (epochs, 3)
        NaN where there is none.
    covariance_enu_m2 : ndarray, shape (epochs, 3, 3)
    clock_m : ndarray, shape (epochs, systems)
        In the order of the series' systems; NaN where a system was not received.
    hpl_m, vpl_m, far_probability : ndarray, shape (epochs,)
    solved : ndarray of bool, shape (epochs,)
        Whether there is a position.
    residual_m, healthy : ndarray, shape (rows,)
        NaN where there is no position; the probability that the range is healthy, or its weight in a city.
    sigma_scale : float
    correlation : float
        Of a satellite's residuals from one epoch to the next.
    rivals : tuple of Elsewhere
    """

    position_m: FloatArray
    velocity_enu_mps: FloatArray
    covariance_enu_m2: FloatArray
    clock_m: FloatArray
    hpl_m: FloatArray
    vpl_m: FloatArray
    far_probability: FloatArray
    solved: BoolArray
    residual_m: FloatArray
    healthy: FloatArray
    sigma_scale: float
    correlation: float
    rivals: tuple[Elsewhere, ...]
