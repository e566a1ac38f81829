"""The verb :func:`locate_stream`: epochs in, fixes out, with memory that does not grow."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Literal, cast

from estimators.arrays import ArrayLike, InputError
from estimators.gnss.options import PositionOptions
from estimators.gnss.series.epochs import Epoch
from estimators.gnss.series.fixes import EpochFix
from estimators.gnss.series.locate_series import CAUSAL_WINDOW_S, CENTRED_WINDOW_S, locate_series
from estimators.result import NoFit
from estimators.time_axis import as_times

_WINDOWS_PER_BLOCK = 10
_MOST_EPOCHS = 2000
"""Of a block: 200 s of ten epochs a second."""


def locate_stream(
    epochs: Iterable[Epoch],
    *,
    motion: Literal["auto", "static", "moving"] = "moving",
    window_s: float | None = None,
    causal: bool = False,
    surroundings: Literal["auto", "open", "city"] = "auto",
    rotated: bool = True,
    options: PositionOptions | None = None,
) -> Iterator[EpochFix | NoFit]:
    """Find positions while epochs come in.

    The stream is cut into blocks of ten windows, each solved by :func:`locate_series` together with as much
    of the blocks around it as its windows reach. What is decided by the data is decided block by block; a
    standing receiver has a position for each.

    Parameters
    ----------
    epochs : iterable of Epoch
        In order of time; consumed as answers are asked for.
    motion, window_s, causal, surroundings, rotated, options
        As of :func:`locate_series`.

    Yields
    ------
    EpochFix or NoFit
        One per epoch, in order. ``NoFit`` for the epochs of a block in which no epoch has a position.

    Raises
    ------
    InputError
        If times go back, or an epoch is not one.

    Examples
    --------
    >>> list(locate_stream([]))
    []
    """
    if window_s is not None and not window_s > 0.0:
        raise InputError("window_s", "must be a positive number of seconds")
    length = window_s if window_s is not None else CAUSAL_WINDOW_S if causal else CENTRED_WINDOW_S
    before_s, after_s = (length, 0.0) if causal else (0.5 * length, 0.5 * length)
    held: list[Epoch] = []
    seconds: list[float] = []
    answered = 0
    zero: Epoch | None = None

    def solve(last: int) -> Iterator[EpochFix | NoFit]:
        fixes = locate_series(
            held,
            motion=motion,
            window_s=window_s,
            causal=causal,
            surroundings=surroundings,
            rotated=rotated,
            options=options,
        )
        for k in range(answered, last):
            yield fixes if isinstance(fixes, NoFit) else fixes[k]

    for epoch in epochs:
        zero = epoch if zero is None else zero
        held.append(epoch)
        seconds.append(_since(zero, epoch))
        if len(seconds) > 1 and seconds[-1] < seconds[-2]:
            raise InputError(
                "time", "epochs of a stream come in order of time; sort them, or use locate_series"
            )
        covered = seconds[-1] - seconds[answered]
        if covered >= _WINDOWS_PER_BLOCK * length + after_s or len(held) >= _MOST_EPOCHS:
            # The last epochs wait for those after them, but no longer than memory allows.
            last = next((k for k, s in enumerate(seconds) if s > seconds[-1] - after_s), len(seconds))
            last = max(last, answered + 1, len(held) - _MOST_EPOCHS // 2)
            yield from solve(last)
            first = next((k for k in range(last) if seconds[k] >= seconds[last - 1] - before_s), last)
            first = max(first, last - _MOST_EPOCHS // 4)
            held, seconds, answered = held[first:], seconds[first:], last - first
    if answered < len(held):
        yield from solve(len(held))


def _since(zero: Epoch, epoch: Epoch) -> float:
    try:
        internal, _, _ = as_times(cast("ArrayLike", [zero.time, epoch.time]))
    except (InputError, TypeError) as error:
        raise InputError("time", "send seconds for all epochs, or points in time for all") from error
    return float(internal[1] - internal[0])
