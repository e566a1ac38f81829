"""``clean_trajectory`` and ``clean_in_pieces``: from a caller's rows to a :class:`Track` or pieces of one."""

from __future__ import annotations

import math

import numpy as np

from estimators.arrays import ArrayLike, FloatArray, InputError, Reason
from estimators.result import NoFit, NoFitReason, Points
from estimators.trajectories.methods.registry import TRACK_METHODS
from estimators.trajectories.options import TrackOptions
from estimators.trajectories.pieces import TrackPieces
from estimators.trajectories.reasons import FixReason
from estimators.trajectories.rows import Rows, read_rows
from estimators.trajectories.smoothing.blocks import BLOCK
from estimators.trajectories.solve import solve, whole
from estimators.trajectories.track import Track


def clean_trajectory(
    t_s: ArrayLike,
    lat_deg: ArrayLike,
    lon_deg: ArrayLike,
    *,
    height_m: ArrayLike | None = None,
    accuracy_m: ArrayLike | None = None,
    speed_mps: ArrayLike | None = None,
    bearing_deg: ArrayLike | None = None,
    method: str = "auto",
    level: float = 0.95,
    options: TrackOptions | None = None,
) -> Track | NoFit:
    """Say which fixes of a track lie, and where it really went.

    Every fix gets a label, for the whole track at once: a burst of multipath that fills its own window is
    still off from what came before and after. The track is then smoothed under these labels; noise, motion
    and the rates of faults are estimated, nothing has to be known.

    Parameters
    ----------
    t_s : array_like, shape (n,)
        Seconds, datetime64, ``datetime`` or ISO 8601; any order; NaN, NaT and None are missing.
    lat_deg, lon_deg : array_like, shape (n,)
        Degrees; longitudes from -180 to 360. Rows elsewhere are ``invalid``.
    height_m : array_like, shape (n,), optional
        Metres; may have gaps.
    accuracy_m : array_like, shape (n,), optional
        Radius about each fix that holds 68 % as the receiver reports it; only its proportions count.
    speed_mps, bearing_deg : array_like, shape (n,), optional
        Speed over ground and course, degrees clockwise from north, as the receiver reports them; may have
        gaps. How far they are trusted is found from the track: speeds that disagree with it, or that were
        computed from its positions, are not used.
    method : str
        ``auto`` (default) or another of :func:`estimators.track_methods`.
    level : float
        Confidence level of intervals (default 0.95).
    options : TrackOptions, optional

    Returns
    -------
    Track or NoFit
        ``NoFit`` if no row has both a time and a place on Earth, or all have one time and different places.

    Raises
    ------
    InputError
        If columns differ in length or hold no numbers, or a setting is out of range.
    Cancelled
        If the caller's flag was set (:mod:`estimators.consensus.cancellation`).

    Notes
    -----
    The same input gives the same bytes. METHODS_TRACKS describes the composition and what it reaches.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.arange(60.0)
    >>> rng = np.random.default_rng(1)
    >>> lat = 48.0 + 1e-4 * t + 2e-5 * rng.normal(size=60)
    >>> lon = 11.0 + 3e-5 * rng.normal(size=60)
    >>> lat[30] += 0.01
    >>> track = clean_trajectory(t, lat, lon)
    >>> track.points.reason[29:32]
    ['ok', 'spike', 'ok']
    """
    pieces = clean_in_pieces(
        t_s,
        lat_deg,
        lon_deg,
        height_m=height_m,
        accuracy_m=accuracy_m,
        speed_mps=speed_mps,
        bearing_deg=bearing_deg,
        method=method,
        level=level,
        options=options,
    )
    return pieces if isinstance(pieces, NoFit) else whole(pieces)


def clean_in_pieces(
    t_s: ArrayLike,
    lat_deg: ArrayLike,
    lon_deg: ArrayLike,
    *,
    height_m: ArrayLike | None = None,
    accuracy_m: ArrayLike | None = None,
    speed_mps: ArrayLike | None = None,
    bearing_deg: ArrayLike | None = None,
    method: str = "auto",
    level: float = 0.95,
    options: TrackOptions | None = None,
    piece_rows: int = BLOCK,
) -> TrackPieces | NoFit:
    """Clean a track whose answer need not be held as a whole.

    The pieces on end are the answer of :func:`clean_trajectory`, to the bit; what is kept is about 50 bytes
    per row beside the columns that come in, and 24 more where there are velocities.

    Parameters
    ----------
    t_s, lat_deg, lon_deg, height_m, accuracy_m, speed_mps, bearing_deg, method, level, options
        As for :func:`clean_trajectory`. The columns must not change before the last piece has been taken.
    piece_rows : int
        Rows of a piece (default 65,536); the last is shorter.

    Returns
    -------
    TrackPieces or NoFit
        Pieces in order of time, each with the input rows that it is about.

    Raises
    ------
    InputError
        As :func:`clean_trajectory`, and if ``piece_rows`` is not a positive integer.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.arange(100.0)
    >>> pieces = clean_in_pieces(t, 48.0 + 1e-4 * t, np.full(100, 11.0), piece_rows=40)
    >>> [len(piece) for piece in pieces]
    [40, 40, 20]
    >>> pieces.facts().inliers
    100
    """
    if method not in TRACK_METHODS:
        raise InputError("method", f"unknown method {method!r}; choose one of {', '.join(TRACK_METHODS)}")
    if isinstance(level, bool) or not 0.0 < level < 1.0:
        raise InputError("level", "must lie between 0 and 1, both excluded")
    if isinstance(piece_rows, bool) or not isinstance(piece_rows, int) or piece_rows < 1:
        raise InputError("piece_rows", "must be a positive whole number of rows")
    options = options or TrackOptions()
    rows = read_rows(t_s, lat_deg, lon_deg, height_m, accuracy_m, speed_mps, bearing_deg)
    refused = _refuse(rows)
    if refused is not None:
        return refused
    labeller = TRACK_METHODS[method].labeller
    return solve(rows, lambda measured: labeller(measured, options), method, options, level, piece_rows)


def _refuse(rows: Rows) -> NoFit | None:
    fixes = int(rows.measures.sum())
    if fixes == 0:
        message = (
            "no row has both a time and a place on Earth; give times in t_s, degrees in lat_deg and lon_deg"
        )
        return _no_fit(rows, NoFitReason.no_data, message)
    moments = rows.t[rows.measures]
    if fixes > 1 and not moments[-1] > moments[0]:
        message = "all fixes have the same time and different places; give the time of each"
        return _no_fit(rows, NoFitReason.constant_time, message)
    return None


def _no_fit(rows: Rows, reason: NoFitReason, message: str) -> NoFit:
    n = rows.codes.size
    unknown: FloatArray = np.full(n, math.nan)
    codes = np.where(rows.codes == FixReason.invalid, Reason.invalid, Reason.ok).astype(np.uint8)
    return NoFit(reason, message, Points(np.zeros(n, dtype=np.bool_), unknown, unknown.copy(), codes))
