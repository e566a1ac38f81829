"""``clean_live``: the next rows of a live track, and what was learned from them."""

from __future__ import annotations

import numpy as np

from estimators.arrays import ArrayLike, InputError
from estimators.trajectories.labelling.modes import COLOUR_TIME_S
from estimators.trajectories.live.advance import advance, open_rows, settle
from estimators.trajectories.live.answer import LiveTrack, joined, rows_without_place
from estimators.trajectories.live.arrivals import arrivals, missing_times
from estimators.trajectories.live.stream import LAGS, START, Settings, Stream
from estimators.trajectories.live.token import decode, encode
from estimators.trajectories.options import TrackOptions
from estimators.trajectories.reasons import FixReason
from estimators.trajectories.track import TrackNoise


def clean_live(
    t_s: ArrayLike,
    lat_deg: ArrayLike,
    lon_deg: ArrayLike,
    *,
    height_m: ArrayLike | None = None,
    accuracy_m: ArrayLike | None = None,
    state: str | bytes | None = None,
    lag: int | None = None,
    finish: bool = False,
    options: TrackOptions | None = None,
) -> LiveTrack:
    """Clean a track while it is recorded.

    Each call takes the rows that have come in since the last one, any number of them, and the state that
    the last one gave back. A fix is *settled*, its answer final, when at most ``lag`` later ones are known;
    until then it is answered provisionally. What settled rows say depends on the rows and their order of
    arrival, and not on how they were cut into calls.

    Parameters
    ----------
    t_s, lat_deg, lon_deg, height_m, accuracy_m : array_like, shape (k,)
        As for :func:`estimators.clean_trajectory`; k may be 0. Heights and accuracies are rounded to 32
        bits.
    state : str or bytes, optional
        ``state`` of the last answer; default: a new track.
    lag : int, optional
        Delay in fixes, 4 to 128 (default 32, or that of the state).
    finish : bool
        Whether this is the end: settle all rows now (default False).
    options : TrackOptions, optional
        Default: those of the state.

    Returns
    -------
    LiveTrack

    Raises
    ------
    InputError
        If columns differ in length or hold no numbers, if the state is damaged or none of ours, or if
        ``lag`` or ``options`` are not those with which the track began.

    Notes
    -----
    Rows that come late are sorted in among the open ones; those before the last settled row are
    ``out_of_order``, or ``duplicate``. After eight of them on end the clock has been set back, and the track
    begins anew there. Noise and motion start from priors and are estimated from the last 512 fixes, at fixed
    numbers of fixes. The state is at most 32 kB, holds these fixes and no secret, and is guarded against
    damage, not against forgery: a forged one gives a wrong track to whoever forged it.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.arange(60.0)
    >>> rng = np.random.default_rng(1)
    >>> lat = 48.0 + 1e-4 * t + 2e-5 * rng.normal(size=60)
    >>> lon = 11.0 + 3e-5 * rng.normal(size=60)
    >>> lat[30] += 0.01
    >>> first = clean_live(t[:40], lat[:40], lon[:40])
    >>> len(first.settled), len(first.provisional)
    (9, 31)
    >>> rest = clean_live(t[40:], lat[40:], lon[40:], state=first.state, finish=True)
    >>> rest.settled.row[~rest.settled.inlier].tolist(), len(rest.provisional)
    ([30], 0)
    """
    stream = _begin(lag, options) if state is None else _resume(state, lag, options)
    fixes = arrivals(stream, t_s, lat_deg, lon_deg, height_m, accuracy_m)
    parts = [rows_without_place([], missing_times(0, stream.kind), FixReason.ok)]
    for row, fix in enumerate(fixes, stream.received):
        parts += advance(stream, row, fix)
    if finish:
        parts += settle(stream, stream.open)
    unit = stream.typical_accuracy if np.isfinite(stream.typical_accuracy) else 1.0
    parameters = stream.parameters
    return LiveTrack(
        joined(parts),
        open_rows(stream, stream.open),
        TrackNoise(
            parameters.sigma * unit,
            parameters.colour_m,
            COLOUR_TIME_S,
            parameters.manoeuvre,
            "estimated" if stream.settings.sigma_m is None else "given",
        ),
        encode(stream),
    )


def _begin(lag: int | None, options: TrackOptions | None) -> Stream:
    lag = 32 if lag is None else lag
    if isinstance(lag, bool) or not isinstance(lag, (int, np.integer)) or not LAGS[0] <= lag <= LAGS[1]:
        raise InputError("lag", f"must be a whole number of fixes, {LAGS[0]} to {LAGS[1]}")
    options = options or TrackOptions()
    sigma = options.sigma_m
    parameters = START if sigma is None else START.with_noise(sigma, START.colour_m, START.manoeuvre)
    return Stream(Settings(int(lag), sigma, options.max_speed_mps), parameters=parameters)


def _resume(state: str | bytes, lag: int | None, options: TrackOptions | None) -> Stream:
    stream = decode(state)
    kept = stream.settings
    if lag is not None and lag != kept.lag:
        raise InputError("lag", f"the track began with {kept.lag}; send that, or begin anew without a state")
    for name in () if options is None else ("sigma_m", "max_speed_mps"):
        began = getattr(kept, name)
        if getattr(options, name) != began:
            which = "without one" if began is None else f"with {began:g}"
            raise InputError(
                f"options.{name}",
                f"the track began {which}; send the options of its beginning, or none, or begin anew",
            )
    return stream
