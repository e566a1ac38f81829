"""A moving receiver, window by window: every epoch is answered by a window of bounded length around it.

Windows start where the one before ended up, so that few steps are left to take. Where that leaves many ranges
unexplained, the window starts again from the fixes of single epochs, once with wide noise that narrows as it
goes, and the likeliest path wins (graduated non-convexity; Blake and Zisserman 1987).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from estimators.arrays import FloatArray
from estimators.geodesy.ellipsoid import to_geodetic
from estimators.geodesy.local_frame import enu_axes
from estimators.gnss.options import PositionOptions
from estimators.gnss.series.joint import Elsewhere, Joint
from estimators.gnss.series.motion import FIXED_STATES
from estimators.gnss.series.moving import smooth_window
from estimators.gnss.series.observed import Observations
from estimators.gnss.series.snapshots import START_SCALE
from estimators.gnss.series.spans import Span, plan_windows
from estimators.gnss.series.spread import lag_one, larger_axis, protection, tail, widening
from estimators.gnss.series.track import Track
from estimators.gnss.series.weights import CITY, OPEN
from estimators.gnss.snapshot.solved import SCALE_SHAPE

_ACCELERATION = (1.0, 0.05)
"""Densities of the horizontal and the vertical acceleration of a vehicle, m2/s3 (METHODS_GNSS, "Cities")."""
_STEPS = 30
_SUSPICIOUS = 0.1
"""Share of unexplained ranges from which a window starts again."""
_WIDE_SCALE = 10.0
_SNAPSHOT_UNKNOWNS = 4.0
_NEGLIGIBLE = 1e-12


@dataclass(frozen=True, slots=True)
class Smoothed:
    """A window.

    Attributes
    ----------
    x : ndarray, shape (T, states)
        In the local frame of the window.
    P : ndarray, shape (T, states, states)
        At unit scale.
    residual, weight : ndarray, shape (rows,)
    scale, density, freedom, effective : float
        See :func:`estimators.gnss.series.moving.smooth_window`.
    """

    x: FloatArray
    P: FloatArray
    residual: FloatArray
    weight: FloatArray
    scale: float
    density: float
    freedom: float
    effective: float


def solve_moving(
    observations: Observations,
    track: Track,
    surroundings: int,
    window_s: float,
    causal: bool,
    options: PositionOptions,
    progress: Callable[[int, int], object] | None = None,
) -> Joint:
    """Positions of a moving receiver.

    Parameters
    ----------
    observations : Observations
    track : Track
        Where to start.
    surroundings : int
        ``OPEN`` or ``CITY``.
    window_s : float
    causal : bool
    options : PositionOptions
    progress : callable, optional
        Called with the epochs answered so far and all.
    """
    smoother = _Smoother(observations, track, surroundings, options)
    for span in plan_windows(observations.seconds, window_s, causal):
        smoother.answer(span)
        if progress is not None:
            progress(span.answer_last, len(observations))
    return smoother.joint()


class _Smoother:
    """Goes through the windows of a series; keeps where the last one ended up, and the answers."""

    def __init__(
        self, observations: Observations, track: Track, surroundings: int, options: PositionOptions
    ) -> None:
        self.observations, self.track, self.options = observations, track, options
        self.surroundings = surroundings
        epochs, rows = len(observations), observations.source.size
        self.width = FIXED_STATES + len(observations.letters) - 1
        self.noise = np.array([*_ACCELERATION, *track.clock_noise])
        self.warm = np.full((epochs, self.width), np.nan)
        """Last states in Earth-centred axes; NaN where no window has been."""
        self.position, self.velocity = np.full((epochs, 3), np.nan), np.full((epochs, 3), np.nan)
        self.covariance = np.full((epochs, 3, 3), np.nan)
        self.clock = np.full((epochs, len(observations.letters)), np.nan)
        self.hpl, self.vpl, self.far = (np.full(epochs, np.nan) for _ in range(3))
        self.residual, self.weight = np.full(rows, np.nan), np.full(rows, np.nan)
        self.scales: list[float] = []
        self.correlations: list[float] = []
        self.rivals: list[Elsewhere] = []

    def answer(self, span: Span) -> None:
        """Solve a window and keep what it says of its answered epochs."""
        middle = (span.answer_first + span.answer_last) // 2
        reference = self.track.position_m[middle]
        lat, lon, _ = to_geodetic(reference).tolist()
        axes = enu_axes(lat, lon)
        modes = self._modes(span, reference, axes)
        if not modes:
            return
        best = modes[0]
        self._remember(span, best, reference, axes)
        offsets = self.observations.table.offsets
        base = int(offsets[span.first])
        rows = slice(base, int(offsets[span.last]))
        previous = self.observations.previous[rows] - base
        whitened = best.residual / self.observations.table.sigma_m[rows]
        correlation = lag_one(whitened, best.weight, previous)
        # Where errors last, a window knows a position no better than its epoch alone would.
        epochs = span.last - span.first
        alone = max(_SNAPSHOT_UNKNOWNS * epochs / max(best.effective, 1e-9), 1.0)
        # A reflection lasts as long as the house stands there.
        wider = alone if self.surroundings == CITY else widening(correlation, alone)
        self.scales.append(best.scale)
        self.correlations.append(correlation)
        own = slice(int(offsets[span.answer_first]), int(offsets[span.answer_last]))
        inner = slice(own.start - base, own.stop - base)
        self.residual[own], self.weight[own] = best.residual[inner], best.weight[inner]
        at = slice(span.answer_first - span.first, span.answer_last - span.first)
        answered = slice(span.answer_first, span.answer_last)
        self.position[answered] = reference + best.x[at, :3] @ axes
        self.velocity[answered] = best.x[at, 3:6]
        clocks = np.repeat(best.x[at, 6:7], len(self.observations.letters), axis=1)
        clocks[:, 1:] += best.x[at, FIXED_STATES:]
        self.clock[answered] = clocks + self.track.jumps_m[answered, None]
        self._bound(span, modes, wider, reference, axes)

    def _bound(
        self, span: Span, modes: list[Smoothed], wider: float, reference: FloatArray, axes: FloatArray
    ) -> None:
        """Covariances and protection levels, competing paths included."""
        best = modes[0]
        at = slice(span.answer_first - span.first, span.answer_last - span.first)
        answered = slice(span.answer_first, span.answer_last)
        share = np.array([(mode.density - best.density) / wider for mode in modes])
        share = np.exp(np.maximum(share, math.log(_NEGLIGIBLE)))
        count = span.answer_last - span.answer_first
        weights = np.tile(share / share.sum(), (count, 1))
        moved = np.stack([mode.x[at, :3] - best.x[at, :3] for mode in modes], axis=1)
        spreads = np.stack([wider * mode.scale**2 * mode.P[at, :3, :3] for mode in modes], axis=1)
        distance = np.hypot(moved[..., 0], moved[..., 1])
        nu = 2.0 * SCALE_SHAPE + best.freedom / wider
        across, up = larger_axis(spreads), spreads[..., 2, 2]
        self.covariance[answered] = spreads[:, 0]
        risk = self.options.integrity_risk
        self.far[answered] = tail(np.full(count, self.options.alert_m), distance, across, nu, weights)
        self.hpl[answered] = protection(risk, distance, across, nu, weights)
        self.vpl[answered] = protection(risk, np.abs(moved[..., 2]), up, nu, weights)
        for j in range(1, len(modes)):
            far = int(distance[:, j].argmax())
            if distance[far, j] > 0.5 * self.options.alert_m and weights[0, j] > 1e-9:
                place = reference + modes[j].x[at.start + far, :3] @ axes
                self.rivals.append(
                    Elsewhere(
                        span.answer_first,
                        span.answer_last - 1,
                        place,
                        float(distance[far, j]),
                        float(weights[0, j]),
                    )
                )

    def _modes(self, span: Span, reference: FloatArray, axes: FloatArray) -> list[Smoothed]:
        """Solutions of a window, the likeliest first."""
        window = slice(span.first, span.last)
        cold = self._cold(window, reference, axes)
        warm = cold.copy()
        known = np.isfinite(self.warm[window]).all(axis=1)
        if known.any():
            kept = self.warm[window][known]
            warm[known] = kept
            warm[known, :3] = (kept[:, :3] - reference) @ axes.T
            warm[known, 3:6] = kept[:, 3:6] @ axes.T
        found = [self._smooth(window, warm, START_SCALE, reference, axes)]
        if self.surroundings == OPEN and _is_suspicious(found[0]):
            found.append(self._smooth(window, cold, _WIDE_SCALE, reference, axes))
            if known.any():
                found.append(self._smooth(window, cold, START_SCALE, reference, axes))
        elif found[0] is None and known.any():
            found.append(self._smooth(window, cold, START_SCALE, reference, axes))
        modes = [mode for mode in found if mode is not None]
        modes.sort(key=lambda mode: -mode.density)
        kept_modes: list[Smoothed] = []
        for mode in modes:
            if all(np.abs(mode.x[:, :3] - other.x[:, :3]).max() > 1.0 for other in kept_modes):
                kept_modes.append(mode)
        return kept_modes

    def _cold(self, window: slice, reference: FloatArray, axes: FloatArray) -> FloatArray:
        x = np.zeros((window.stop - window.start, self.width))
        x[:, :3] = (self.track.position_m[window] - reference) @ axes.T
        x[:, 6] = self.track.clock_m[window]
        x[:, FIXED_STATES:] = self.track.offset_m
        return x

    def _remember(self, span: Span, best: Smoothed, reference: FloatArray, axes: FloatArray) -> None:
        window = slice(span.first, span.last)
        self.warm[window] = best.x
        self.warm[window, :3] = reference + best.x[:, :3] @ axes
        self.warm[window, 3:6] = best.x[:, 3:6] @ axes

    def _smooth(
        self, window: slice, x: FloatArray, scale: float, reference: FloatArray, axes: FloatArray
    ) -> Smoothed | None:
        observations, table = self.observations, self.observations.table
        rows = slice(int(table.offsets[window.start]), int(table.offsets[window.stop]))
        n, (epochs, width) = rows.stop - rows.start, x.shape
        if n == 0:
            return None
        x = np.ascontiguousarray(x)
        P, residual, weight = np.zeros((epochs, width, width)), np.zeros(n), np.zeros(n)
        taken, spread, density, freedom, effective = smooth_window(
            table.satellites_m[rows],
            table.pseudoranges_m[rows] - self.track.row_jumps_m[rows],
            table.sigma_m[rows],
            observations.system[rows],
            observations.velocity_mps[rows],
            observations.range_rate_mps[rows],
            table.offsets[window.start : window.stop + 1] - rows.start,
            observations.seconds[window],
            table.rotated,
            reference,
            axes,
            self.noise,
            self.surroundings,
            self.options.fault_prior,
            1.0 if self.surroundings == CITY else scale,
            _STEPS,
            x,
            P,
            residual,
            weight,
        )
        if taken < 0.0 or not np.isfinite(x).all():
            return None
        if self.surroundings == CITY:
            # Weights that take off what reflections add leave residuals that understate the noise.
            spread = max(spread, 1.0)
        return Smoothed(x, P, residual, weight, spread, density, freedom, effective)

    def joint(self) -> Joint:
        """Put the answers of all windows together."""
        absent = np.ones(self.clock.shape, dtype=np.bool_)
        epoch = np.repeat(np.arange(len(self.observations)), np.diff(self.observations.table.offsets))
        absent[epoch, self.observations.system] = False
        return Joint(
            position_m=self.position,
            velocity_enu_mps=self.velocity,
            covariance_enu_m2=self.covariance,
            clock_m=np.where(absent, np.nan, self.clock),
            hpl_m=self.hpl,
            vpl_m=self.vpl,
            far_probability=self.far,
            solved=np.isfinite(self.position).all(axis=1),
            residual_m=self.residual,
            healthy=self.weight,
            sigma_scale=float(np.median(self.scales)) if self.scales else math.nan,
            correlation=float(np.median(self.correlations)) if self.correlations else 0.0,
            rivals=tuple(self.rivals),
        )


def _is_suspicious(mode: Smoothed | None) -> bool:
    return mode is None or float(np.mean(mode.weight < 0.5)) > _SUSPICIOUS
