r"""Reported speeds and courses as velocities in the plane, and how far they can be trusted.

How good they are is not asked but measured: over a span T the way by integrated velocities differs from the
way between fixes by a variance 2 s^2 + S T per axis, s^2 the noise of fixes and S the spectral density of the
velocities' errors. Two spans give S, whether the errors are white or last; speeds in another unit have a
large one, and so no say. Velocities that repeat the differences of neighbouring fixes were computed from
them: they carry the same errors again, and are left out.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.ndimage import median_filter

from estimators.arrays import BoolArray, FloatArray
from estimators.geodesy.plane import Plane
from estimators.trajectories.projected import Projected
from estimators.trajectories.spans import start_from_spans

_AHEAD_DEG = 1e-4
_SLOW_MPS = 0.5
"""Slower than this a course says nothing, and a missing one is not missed."""
_QUANTILE = 0.2
_SHORT_S, _LONG_S = 8.0, 32.0
_FEWEST = 16
_LEAST_SHARE = 1.0 / 8.0
"""Of the difference over the long span, at least so much is held to be the velocities'."""
_LEAST_MPS = 0.1
_OFF_MPS, _OFF_SIGMAS = 1.0, 3.0
"""By how much velocities may be off the way between fixes, besides the noise of these."""
_ALIKE = 0.1
"""Excess of changes that point where the errors of fixes do."""
_SHORTEST_S = 1e-9
_LONGEST_STEP_S = 5.0
"""A velocity at a moment tells little of what comes long before or after."""


def velocities(
    plane: Plane,
    latitude_deg: FloatArray,
    longitude_deg: FloatArray,
    speed_mps: FloatArray,
    bearing_deg: FloatArray,
) -> FloatArray:
    """East and north velocities along the axes of a plane; NaN where they are not known.

    Parameters
    ----------
    plane : Plane
        Its axes turn away from north, far from its centre.
    latitude_deg, longitude_deg : ndarray, shape (n,)
    speed_mps, bearing_deg : ndarray, shape (n,)
        NaN where there is none; bearings clockwise from north.

    Returns
    -------
    ndarray, shape (n, 2)
    """
    toward = np.where(latitude_deg > 0.0, -_AHEAD_DEG, _AHEAD_DEG)
    step = plane.project(latitude_deg + toward, longitude_deg) - plane.project(latitude_deg, longitude_deg)
    north = step * np.sign(toward)[:, None]
    north = north / np.hypot(north[:, 0], north[:, 1])[:, None]
    east = np.column_stack([north[:, 1], -north[:, 0]])
    bearing = np.radians(np.where(np.isnan(bearing_deg) & (speed_mps < _SLOW_MPS), 0.0, bearing_deg))
    along = np.cos(bearing)[:, None] * north + np.sin(bearing)[:, None] * east
    return np.asarray(speed_mps[:, None] * along)


def velocity_variance(t: FloatArray, fixes: FloatArray, velocity: FloatArray) -> FloatArray:
    """Variance per axis with which each velocity may be taken; infinite where it is not to be.

    Parameters
    ----------
    t : ndarray, shape (n,)
        Seconds, ascending.
    fixes, velocity : ndarray, shape (n, 2)
        NaN where there is no velocity.

    Returns
    -------
    ndarray, shape (n,)
    """
    unused = np.full(t.size, np.inf)
    known = np.isfinite(velocity[:, 0])
    steps = np.diff(t[known])
    if steps.size < _FEWEST or not np.median(steps) > 0.0:
        return unused
    step = float(np.median(steps))
    if step > _LONGEST_STEP_S or _are_copied(t[known], fixes[known], velocity[known]):
        return unused
    way = 0.5 * steps[:, None] * (velocity[known][1:] + velocity[known][:-1])
    rest = fixes[known] - np.vstack([np.zeros(2), np.cumsum(way, axis=0)])
    short, long = (max(1, round(span / step)) for span in (_SHORT_S, _LONG_S))
    if long <= short or rest.shape[0] < long + _FEWEST:
        return unused
    near, far = (_variance(rest[k:] - rest[:-k]) for k in (short, long))
    noise = math.exp(2.0 * float(start_from_spans(t[known], fixes[known])[0]))
    density = max(
        (far - near) / ((long - short) * step),
        (near - 2.0 * noise) / (short * step),
        _LEAST_SHARE * far / (long * step),
    )
    variance = max(density / step, _LEAST_MPS**2)
    # A course at walking pace may be anything.
    speed = np.hypot(velocity[:, 0], velocity[:, 1])
    slow = np.where(speed < _SLOW_MPS, speed**2, 0.0)
    trusted = np.zeros(t.size, dtype=np.bool_)
    trusted[known] = _agree(t[known], rest, short, noise)
    return np.where(trusted, variance + slow, np.inf)


def trusted_velocities(
    t: FloatArray, fixes: Projected, velocity: FloatArray | None, measures: BoolArray
) -> tuple[FloatArray | None, FloatArray | None]:
    """Velocities of rows and their variances, as far as they can be trusted.

    Parameters
    ----------
    t : ndarray, shape (m,)
        Seconds, ascending.
    fixes : Projected
    velocity : ndarray, shape (m, 2), or None
        NaN where there is none.
    measures : ndarray of bool, shape (m,)
        Rows by which velocities are judged, and of which they are taken.

    Returns
    -------
    velocity : ndarray, shape (m, 2), or None
        0 where there is none; None if no velocity is to be used.
    variance : ndarray, shape (m,), or None
        Per axis; infinite where a velocity is not to be used.
    """
    if velocity is None:
        return None, None
    used = np.flatnonzero(measures)
    variance = np.full(t.size, np.inf)
    variance[used] = velocity_variance(t[used], fixes[used], velocity[used])
    if np.isinf(variance).all():
        return None, None
    return np.nan_to_num(velocity), variance


def _are_copied(t: FloatArray, fixes: FloatArray, velocity: FloatArray) -> bool:
    """Whether velocities change as the errors of fixes do, because they were computed from them.

    How far a fix is from the line between its neighbours is mostly its error, and where it is not, a change
    of velocity points the other way. Only signs count, so that faults count no more than others.
    """
    share = (t[1:-1] - t[:-2]) / np.maximum(t[2:] - t[:-2], _SHORTEST_S)
    error = fixes[1:-1] - fixes[:-2] - share[:, None] * (fixes[2:] - fixes[:-2])
    change = np.diff(velocity, axis=0)
    alike = [
        float(np.mean(np.sign(np.sum(error[1:-1] * change[first : first + len(error) - 2], axis=1))))
        for first in range(4)
    ]
    return max(alike) > _ALIKE + 3.0 / math.sqrt(len(error))


def _agree(t: FloatArray, rest: FloatArray, beside: int, noise: float) -> BoolArray:
    """Whether velocities agree with the fixes before them or with those after them.

    A receiver's speed that has frozen agrees with neither. Where positions jump, those on one side of the
    jump still agree. Medians of slopes leave out faults that are alone.

    Parameters
    ----------
    t : ndarray, shape (n,)
    rest : ndarray, shape (n, 2)
        Fixes less integrated velocities: level where both agree.
    beside : int
        Fixes in a short span; half of what is looked at on either side.
    noise : float
        Variance of fixes per axis.
    """
    waited = np.maximum(t[beside:] - t[:-beside], _SHORTEST_S)
    slopes = (rest[beside:] - rest[:-beside]) / waited[:, None]
    # The one at place k is the median of those from k on, over 2 * beside fixes.
    middle = median_filter(slopes, size=(2 * (beside // 2) + 1, 1), mode="nearest")
    off = np.hypot(middle[:, 0], middle[:, 1])
    limit = _OFF_MPS + _OFF_SIGMAS * math.sqrt(2.0 * noise * math.pi / beside) / float(np.median(waited))
    fine = off <= limit
    rows, half = np.arange(t.size), beside // 2
    after = fine[np.minimum(rows + half, fine.size - 1)]
    before = fine[np.clip(rows - 2 * beside + half, 0, fine.size - 1)]
    return np.asarray(after | before)


def _variance(off: FloatArray) -> float:
    """Per axis, from a low quantile of squared distances, which faults leave alone."""
    return float(np.quantile(np.sum(off * off, axis=1), _QUANTILE)) / (-2.0 * math.log1p(-_QUANTILE))
