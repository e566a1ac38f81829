"""Parameters of a track by their evidence: the likelihood of the labelled track, and wide priors.

The likelihood knows the labels' doubts, so that it does not take a burst for a manoeuvre nor noise for
spikes; least squares on differences only says where to start (:mod:`estimators.trajectories.spans`). A long
track is judged by windows of it, and with a narrower beam than it is labelled with.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from estimators.arrays import BoolArray, CodeArray, FloatArray
from estimators.consensus.cancellation import stop_if_cancelled
from estimators.trajectories.climbing import climb, mean_square
from estimators.trajectories.labelling.beam import HOPELESS, WIDTH
from estimators.trajectories.labelling.evidence import judge_labels
from estimators.trajectories.labelling.modes import (
    ADRIFT,
    BURST,
    ENTRY,
    HURRIED,
    LEVEL_STRIDE,
    REDRAW,
    SPIKE,
    WIDE,
)
from estimators.trajectories.labelling.passage import Passage
from estimators.trajectories.parameters import Rates, TrackParameters
from estimators.trajectories.spans import PRIOR_LOG, PRIOR_SPREAD, start_from_spans
from estimators.trajectories.stale import rounding_of

WINDOW = 256
WINDOWS = 4
"""A track of more fixes than both together is judged by so many windows of so many fixes."""
_STRIDES = ((4, 2), (2, 1), (1,))
"""Of the search, in units of its grid; the track is labelled anew between."""
_HIDES, _SHORTEST_S = 2.0, 1e-6
"""Times that what cannot be foretold of the motion hides noise."""
_ROUNDED, _FINEST_M = 0.5, 1e-2
"""Noise of what is rounded to units: it lasts while a track is slow, so that it is more than 12**-0.5. The
least there is."""
_REPORTED_LOG, _REPORTED_SPREAD = np.log(0.66), 0.4
"""White noise in units of a reported 68 % radius; 1/1.515 for two normal axes."""
_LEAST_LOG, _LARGEST_LOG = np.log([1e-2, 1e-2, 1e-6]), np.log([1e4, 1e3, 1e4])
_ROUNDS = 2
_CALMER = 4.0
"""Differences take manoeuvres for the usual motion: the search also begins with a density so much smaller, as
a logarithm."""
_WIDTH, _HOPELESS = 8, 10.0
"""Of the beam while parameters are sought."""


@dataclass(frozen=True, slots=True)
class Measured:
    """Fixes that measure something, in order of time.

    Attributes
    ----------
    t : ndarray, shape (n,)
        Seconds.
    fixes : ndarray, shape (n, 2)
        East and north, metres.
    reported : ndarray, shape (n,), or None
        Radii that hold 68 % as the receiver reports them, metres.
    velocity : ndarray, shape (n, 2), or None
        East and north as the receiver reports them, m/s.
    velocity_variance : ndarray, shape (n,), or None
        Per axis; infinite where there is no velocity to be trusted.
    """

    t: FloatArray
    fixes: FloatArray
    reported: FloatArray | None
    velocity: FloatArray | None = None
    velocity_variance: FloatArray | None = None

    @property
    def size(self) -> int:
        """Number of fixes."""
        return int(self.t.size)

    def velocities(self) -> tuple[FloatArray, FloatArray]:
        """Velocities and their variances; infinite ones where there are none."""
        if self.velocity is None or self.velocity_variance is None:
            return np.zeros((self.t.size, 2)), np.full(self.t.size, np.inf)
        return self.velocity, self.velocity_variance

    def variance(self, parameters: TrackParameters) -> FloatArray:
        """Variance of white noise per axis and fix."""
        unit = np.ones(self.t.size) if self.reported is None else self.reported
        return np.ascontiguousarray((parameters.sigma * unit) ** 2)

    def window(self, first: int, last: int) -> Measured:
        """Give some fixes on end."""
        return self._part(slice(first, last))

    def backward(self) -> Measured:
        """Give the track as it is read backward."""
        turned = self._part(slice(None, None, -1))
        velocity = None if turned.velocity is None else -turned.velocity
        return replace(turned, t=-turned.t, velocity=velocity)

    def where(self, chosen: BoolArray) -> Measured:
        """Give the chosen fixes."""
        return self._part(chosen)

    def _part(self, rows: BoolArray | slice) -> Measured:
        def part(column: FloatArray | None) -> FloatArray | None:
            return None if column is None else np.ascontiguousarray(column[rows])

        return Measured(
            np.ascontiguousarray(self.t[rows]),
            np.ascontiguousarray(self.fixes[rows]),
            part(self.reported),
            part(self.velocity),
            part(self.velocity_variance),
        )


def label(
    measured: Measured,
    parameters: TrackParameters,
    lag: int = 0,
    *,
    width: int = WIDTH,
    hopeless: float = HOPELESS,
    top_speed: float = np.inf,
) -> tuple[CodeArray, FloatArray, float]:
    """Label fixes under given parameters.

    Returns
    -------
    labels : ndarray of uint8, shape (n,)
    probability : ndarray, shape (n,)
        Of each fix to be good; 1 without a lag.
    evidence : float
        Log likelihood.
    """
    n = measured.t.size
    passage = Passage(n, parameters, lag, width, hopeless, top_speed)
    variance = measured.variance(parameters)
    passage.follow(measured.t, measured.fixes, variance, *measured.velocities(), is_last=True)
    return passage.labels, passage.probability if lag else np.ones(n), passage.evidence


def judge(measured: Measured, parameters: TrackParameters, labels: CodeArray) -> float:
    """Log likelihood of given labels."""
    return judge_labels(
        measured.t,
        measured.fixes,
        measured.variance(parameters),
        *measured.velocities(),
        parameters.colour_m,
        parameters.manoeuvre,
        parameters.rates.as_array(),
        np.ascontiguousarray(labels),
        np.empty_like(labels),
    )


def estimate(measured: Measured, sigma_m: float | None = None, top_speed: float = np.inf) -> TrackParameters:
    """Find noise, motion and rates of a track.

    Parameters
    ----------
    measured : Measured
        At least two fixes.
    sigma_m : float, optional
        Standard deviation of white noise per axis, of a fix of median reported accuracy; it is then kept.
    top_speed : float
        m/s.
    """
    # Positions alone: velocities make a finer prediction, against which noise that lasts looks like motion.
    windows = _windows(replace(measured, velocity=None, velocity_variance=None))
    rates = Rates()
    mean, spread = PRIOR_LOG.copy(), PRIOR_SPREAD.copy()
    if measured.reported is not None:
        mean[0], spread[0] = _REPORTED_LOG, _REPORTED_SPREAD
    axes: tuple[int, ...] = (2, 0, 1)
    if sigma_m is not None:
        unit = 1.0 if measured.reported is None else float(np.median(measured.reported))
        mean[0] = np.log(sigma_m / unit)
        axes = (2, 1)

    def penalty(logs: FloatArray) -> float:
        return float(0.5 * np.sum(((logs - mean) / spread) ** 2))

    def relabelled(logs: FloatArray) -> tuple[list[CodeArray], float]:
        told = [
            label(window, _parameters(logs, rates), width=_WIDTH, hopeless=_HOPELESS, top_speed=top_speed)
            for window in windows
        ]
        return [one[0] for one in told], sum(one[2] for one in told) - penalty(logs)

    def under(labels: list[CodeArray]) -> Callable[[FloatArray], float]:
        def evidence(logs: FloatArray) -> float:
            stop_if_cancelled()
            parameters = _parameters(logs, rates)
            judged = [judge(window, parameters, given) for window, given in zip(windows, labels, strict=True)]
            return sum(judged) - penalty(logs)

        return evidence

    def higher(labels: list[CodeArray], logs: FloatArray, strides: tuple[int, ...]) -> FloatArray:
        return climb(under(labels), logs, axes, strides, least, _LARGEST_LOG)

    least = _LEAST_LOG.copy()
    if measured.reported is None:
        least[0] = max(least[0], np.log(_ROUNDED * rounding_of(measured.fixes) + _FINEST_M))
    start = start_from_spans(measured.t, measured.fixes)
    if measured.reported is not None or sigma_m is not None:
        start[0] = mean[0]
    calm = start - np.array([0.0, 0.0, _CALMER])
    reached = []
    for one in (start, calm, mean):
        there = np.clip(one, least, _LARGEST_LOG)
        there = higher(relabelled(there)[0], there, _STRIDES[0])
        labels, worth = relabelled(there)
        reached.append((worth, there, labels))
    best, logs, labels = max(reached, key=lambda one: one[0])
    for strides in _STRIDES[1:]:
        there = higher(labels, logs, strides)
        labels, worth = relabelled(there)
        if worth > best:
            best, logs = worth, there
    if sigma_m is None:
        logs = mean_square(under(labels), logs, 0)
        logs[0] = max(logs[0], least[0], _hidden_noise(measured, logs))
    for _ in range(_ROUNDS):
        rates = _rates(windows, _parameters(logs, rates))
    return _parameters(logs, rates)


def _hidden_noise(measured: Measured, logs: FloatArray) -> float:
    """Least logarithm of noise that fixes so far apart allow to deny: less than it hides in the motion."""
    if measured.reported is not None or measured.t.size < 2:
        return float(logs[0])
    step = float(np.median(np.diff(measured.t)))
    motion = 0.5 * (logs[2] + np.log(max(step, _SHORTEST_S) ** 3 / 3.0))
    return float(min(PRIOR_LOG[0], motion - np.log(_HIDES)))


def from_spans(measured: Measured, sigma_m: float | None = None) -> TrackParameters:
    """Find noise and motion from differences alone, with the default rates."""
    logs = start_from_spans(measured.t, measured.fixes)
    unit = 1.0 if measured.reported is None else float(np.median(measured.reported))
    logs[0] = logs[0] - np.log(unit) if sigma_m is None else np.log(sigma_m / unit)
    return _parameters(np.clip(logs, _LEAST_LOG, _LARGEST_LOG), Rates())


def _parameters(logs: FloatArray, rates: Rates) -> TrackParameters:
    sigma, colour, manoeuvre = np.exp(logs).tolist()
    return TrackParameters(sigma, colour, manoeuvre, rates)


def _windows(measured: Measured) -> list[Measured]:
    n = measured.t.size
    if n <= WINDOW * WINDOWS:
        return [measured]
    firsts = np.linspace(0, n - WINDOW, WINDOWS).astype(np.int64).tolist()
    return [measured.window(first, first + WINDOW) for first in firsts]


def _rates(windows: list[Measured], parameters: TrackParameters) -> Rates:
    """Rates at which labels occur, each with a wide prior about its default."""
    fixes = entries = spikes = changes = 0.0
    good_s = 0.0
    for window in windows:
        labels = label(window, parameters, width=_WIDTH, hopeless=_HOPELESS)[0]
        kind = labels % LEVEL_STRIDE
        waited = np.diff(window.t, prepend=window.t[0])
        fixes += labels.size
        spikes += np.count_nonzero(kind == SPIKE)
        entries += np.count_nonzero((kind == ENTRY) | ((kind == ADRIFT) & (labels != ADRIFT)))
        good_s += float(waited[~np.isin(kind, (ENTRY, BURST, REDRAW, ADRIFT))].sum())
        levels = labels[kind <= WIDE] // LEVEL_STRIDE
        levels = np.where(levels == HURRIED, 0, levels)
        changes += np.count_nonzero(np.diff(levels.astype(np.int64)))
    default = Rates()
    return replace(
        default,
        spike=float(np.clip((spikes + 100 * default.spike) / (fixes + 100), 0.002, 0.4)),
        entry=float(min(0.1, (entries + 1.0) / (good_s + 1.0 / default.entry))),
        level=float(min(0.1, (changes + 1.0) / (good_s + 1.0 / default.level))),
    )
