"""The verb :func:`locate_series`: epochs solved jointly, where the receiver stands and where it moves."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Literal

import numpy as np

from estimators.arrays import InputError, Reason
from estimators.gnss.methods.registry import POSITION_METHODS
from estimators.gnss.options import PositionOptions
from estimators.gnss.series.assemble import Settled, make_fixes
from estimators.gnss.series.choice import Motion, Surroundings, choose_motion, choose_surroundings
from estimators.gnss.series.epochs import Epoch
from estimators.gnss.series.fixes import Fixes
from estimators.gnss.series.independent import solve_each
from estimators.gnss.series.joint import Joint
from estimators.gnss.series.observed import MISSING, Observations, observe
from estimators.gnss.series.snapshots import Snapshots, solvable, spread_evenly, take_snapshots
from estimators.gnss.series.static import Climbed, solve_standing, stand
from estimators.gnss.series.track import epochs_to_start, lay_track
from estimators.gnss.series.weights import CITY, OPEN
from estimators.gnss.series.windows import solve_moving
from estimators.result import NoFit, NoFitReason, Points

CENTRED_WINDOW_S, CAUSAL_WINDOW_S = 20.0, 40.0
"""METHODS_GNSS, "Cities"."""
_MOST_STARTS = 24
_ASKED = "As asked for."


def locate_series(
    epochs: Sequence[Epoch],
    *,
    motion: Literal["auto", "static", "moving", "independent"] = "auto",
    window_s: float | None = None,
    causal: bool = False,
    surroundings: Literal["auto", "open", "city"] = "auto",
    rotated: bool = True,
    method: str = "auto",
    options: PositionOptions | None = None,
    progress: Callable[[int, int], object] | None = None,
) -> Fixes | NoFit:
    """Find the positions of a receiver over many epochs, and the ranges that lie.

    Parameters
    ----------
    epochs : sequence of Epoch
        A list, or the columns of :class:`~estimators.gnss.series.epochs.Epochs`; in any order.
    motion : {"auto", "static", "moving", "independent"}
        ``static``: one position for all; ``moving``: constant velocity with white acceleration, in windows;
        ``independent``: each epoch by itself, as :func:`estimators.locate` does. ``auto`` decides by the
        data.
    window_s : float, optional
        Of a moving receiver: seconds of epochs that answer an epoch. Default 20, and 40 if ``causal``.
    causal : bool
        Whether an epoch may be answered by itself and earlier ones only.
    surroundings : {"auto", "open", "city"}
        Of a moving receiver: ``open`` takes faults to lengthen and to shorten ranges, ``city`` weighs ranges
        one-sidedly, since reflections only lengthen them.
    rotated : bool
        Whether satellite positions are in the frame of the time of reception; see :func:`estimators.locate`.
    method : str
        Of fault exclusion; any other than ``auto`` works on single epochs and needs
        ``motion="independent"``.
    options : PositionOptions, optional
    progress : callable, optional
        Called as ``progress(done, total)`` with epochs.

    Returns
    -------
    Fixes or NoFit
        ``NoFit`` (falsy) where no epoch gives a position. Epochs without one keep their row.

    Raises
    ------
    InputError
        If the input cannot be a series; the message names the epoch.

    Notes
    -----
    Joint epochs exclude what single ones cannot: with four of nine satellites at fault in every epoch, the
    position that all epochs share is still unique (METHODS_GNSS, "Limits").

    Examples
    --------
    >>> import numpy as np
    >>> from estimators.geodesy.ellipsoid import to_cartesian
    >>> here = to_cartesian(np.array([52.5, 13.4, 80.0]))
    >>> sky = [[60, 10], [20, -30], [48, 40], [75, 100], [30, 60], [52, -10], [40, 13]]
    >>> satellites = to_cartesian(np.array([[lat, lon, 20.2e6] for lat, lon in sky]))
    >>> ranges = np.linalg.norm(satellites - here, axis=1)
    >>> faulty = ranges + np.array([80.0, 0, 0, 0, 0, 250.0, 0])
    >>> fixes = locate_series([Epoch(0.0, satellites, ranges), Epoch(30.0, satellites, faulty + 50.0)])
    >>> fixes.motion, bool(np.linalg.norm(fixes.position_ecef_m[1] - here) < 1e-3)
    ('static', True)
    """
    settings = PositionOptions() if options is None else options
    _check(motion, window_s, causal, surroundings, method)
    observations = observe(epochs, rotated, settings.elevation_mask_deg)
    length = float(window_s) if window_s is not None else CAUSAL_WINDOW_S if causal else CENTRED_WINDOW_S
    able = solvable(observations)
    if able.size == 0:
        return _no_position(observations)
    snapshots = take_snapshots(observations, spread_evenly(able, _MOST_STARTS), settings)
    if snapshots.epochs.size == 0:
        return _no_position(observations, NoFitReason.undetermined_geometry)
    places: list[Climbed] = []
    if motion in {"auto", "static"} and not (motion == "auto" and len(observations) < 2):
        places = stand(snapshots, settings)
    moves: Motion
    moves, why = (
        (motion, _ASKED)
        if motion != "auto"
        else choose_motion(observations, snapshots, places, settings, length)
    )
    if moves == "static" and causal:
        moves, why = "moving", f"{why} Solved as moving, since one place for all is known at the end only."
    around: Surroundings
    around, reason = (
        (surroundings, _ASKED) if surroundings != "auto" else choose_surroundings(snapshots, settings)
    )
    settled = Settled(moves, why, around, reason, length if moves == "moving" else None, causal)
    if moves == "independent":
        return solve_each(epochs, observations, settled, method, settings, progress)
    joint = _solve(observations, snapshots, places, settled, settings, progress)
    if joint is None or not joint.solved.any():
        return _no_position(observations, NoFitReason.undetermined_geometry)
    fixes = make_fixes(observations, joint, settled, settings)
    if not fixes.solved.any():
        return _no_position(observations, NoFitReason.implausible_position)
    return fixes


def _check(motion: str, window_s: float | None, causal: bool, surroundings: str, method: str) -> None:
    if motion not in {"auto", "static", "moving", "independent"}:
        raise InputError("motion", "must be one of: auto, static, moving, independent")
    if surroundings not in {"auto", "open", "city"}:
        raise InputError("surroundings", "must be one of: auto, open, city")
    if window_s is not None and not (math.isfinite(window_s) and window_s > 0.0):
        raise InputError("window_s", "must be a positive number of seconds")
    if method not in POSITION_METHODS:
        raise InputError("method", f"must be one of: {', '.join(POSITION_METHODS)}")
    if method != "auto" and motion != "independent":
        raise InputError("method", f"{method!r} works on single epochs; send motion='independent' with it")
    if causal and motion == "static":
        raise InputError("causal", "one position for all epochs uses later ones; send motion='moving'")


def _solve(
    observations: Observations,
    snapshots: Snapshots,
    places: list[Climbed],
    settled: Settled,
    options: PositionOptions,
    progress: Callable[[int, int], object] | None,
) -> Joint | None:
    if settled.motion == "static":
        joint = solve_standing(observations, places, options)
        if progress is not None:
            progress(len(observations), len(observations))
        return joint
    starts = epochs_to_start(observations)
    if not np.array_equal(starts, snapshots.epochs):
        snapshots = take_snapshots(observations, starts, options)
    if snapshots.epochs.size == 0:
        return None
    return solve_moving(
        observations,
        lay_track(observations, snapshots, options.fault_prior),
        CITY if settled.surroundings == "city" else OPEN,
        settled.window_s or CENTRED_WINDOW_S,
        settled.causal,
        options,
        progress,
    )


_MESSAGES = {
    NoFitReason.too_few_satellites: (
        "no epoch has as many usable satellites as unknowns, a position and a clock per system; send epochs "
        "with more satellites"
    ),
    NoFitReason.undetermined_geometry: (
        "the directions to the satellites do not determine a position in any epoch; send satellites that are "
        "spread over the sky, and more than one per system"
    ),
    NoFitReason.implausible_position: (
        "the ranges meet where no receiver is; check units, satellite clocks and the frame of the satellite "
        "positions"
    ),
}


def _no_position(observations: Observations, reason: NoFitReason = NoFitReason.too_few_satellites) -> NoFit:
    n = observations.left_out.size
    codes = np.where(observations.left_out == MISSING, Reason.missing, Reason.ok).astype(np.uint8)
    points = Points(np.zeros(n, dtype=np.bool_), np.full(n, np.nan), np.full(n, np.nan), codes)
    return NoFit(reason, _MESSAGES[reason], points)
