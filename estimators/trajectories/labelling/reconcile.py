"""One sequence of labels from two: that of a beam read forward and that of one read backward.

A beam decides by what is behind it, and looks ahead only by as much as it holds hypotheses; read backward, it
errs elsewhere. Where the two differ, each is judged with what both agree upon before and behind.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from estimators.arrays import BoolArray, CodeArray, FloatArray
from estimators.trajectories.labelling.modes import (
    ADRIFT,
    BURST,
    ENTRY,
    LEVEL_STRIDE,
    NOMINAL,
    REDRAW,
    SPIKE,
    WIDE,
)
from estimators.trajectories.stale import runs_of

_MARGIN = 60
"""Fixes on either side by which a difference is judged."""

_LONGEST = 1 << 17
"""Fixes of a stretch that is read another way; some 20 MB while it is."""

Judge = Callable[[slice, CodeArray], float]
"""From some fixes on end and their labels to their log likelihood."""


def reconcile(
    forward: CodeArray, backward: CodeArray, sure: FloatArray, sure_backward: FloatArray, judge: Judge
) -> tuple[CodeArray, FloatArray]:
    """Take each part from the sequence that is likelier there.

    Parameters
    ----------
    forward, backward : ndarray of uint8, shape (n,)
        Labels, both in order of time.
    sure, sure_backward : ndarray, shape (n,)
        Probabilities of the fixes to be good, as either sees them.
    judge : callable

    Returns
    -------
    labels : ndarray of uint8, shape (n,)
    probability : ndarray, shape (n,)
    """
    labels, probability = forward.copy(), sure.copy()
    good, good_backward = is_good(forward), is_good(backward)
    parts = _parts(good, good_backward)
    for first, stop in parts:
        around = slice(
            _agreed(good & good_backward, first, -_MARGIN), _agreed(good & good_backward, stop, _MARGIN)
        )
        other = labels[around].copy()
        other[first - around.start : stop - around.start] = backward[first:stop]
        if judge(around, other) > judge(around, labels[around]):
            labels[first:stop], probability[first:stop] = backward[first:stop], sure_backward[first:stop]
    return labels, probability


def doubtful(labels: CodeArray) -> list[slice]:
    """Stretches that another reading may label otherwise: all but usual fixes and spikes, with a margin."""
    plain = np.isin(labels, (NOMINAL, WIDE)) | (labels % LEVEL_STRIDE == SPIKE)
    odd = np.flatnonzero(~plain)
    if odd.size == 0:
        return []
    breaks = np.flatnonzero(np.diff(odd) > 2 * _MARGIN)
    firsts, lasts = odd[np.concatenate([[0], breaks + 1])], odd[np.concatenate([breaks, [odd.size - 1]])]
    n = labels.size
    return [
        part
        for first, last in zip(firsts.tolist(), lasts.tolist(), strict=True)
        for part in _not_longer(labels, max(first - _MARGIN, 0), min(last + 1 + _MARGIN, n))
    ]


def _not_longer(labels: CodeArray, first: int, stop: int) -> Iterator[slice]:
    """Cut a stretch that is too long to be held where most fixes on end are good."""
    while stop - first > _LONGEST:
        latter = first + _LONGEST // 2
        runs = runs_of(is_good(labels[latter : first + _LONGEST]))
        begin, end = max(runs, key=lambda run: run[1] - run[0], default=(0, _LONGEST))
        cut = latter + (begin + end) // 2
        yield slice(first, cut)
        first = cut
    yield slice(first, stop)


def is_good(labels: CodeArray) -> BoolArray:
    """Mark fixes that tell where the track is."""
    return ~np.isin(labels % LEVEL_STRIDE, (SPIKE, ENTRY, BURST, REDRAW, ADRIFT))


def _parts(good: BoolArray, good_backward: BoolArray) -> list[tuple[int, int]]:
    """Stretches in which the two differ, between fixes that both call good."""
    either = ~(good & good_backward)
    differs = np.concatenate([[0], np.cumsum(good != good_backward)])
    edges = np.flatnonzero(np.diff(np.concatenate([[False], either, [False]]).astype(np.int8)))
    return [
        (int(first), int(stop))
        for first, stop in edges.reshape(-1, 2).tolist()
        if differs[stop] > differs[first]
    ]


def _agreed(both: BoolArray, place: int, by: int) -> int:
    """Place so many fixes on where both are good, or the end."""
    n = both.size
    at = min(max(place + by, 0), n)
    while 0 < at < n and not both[at]:
        at += 1 if by > 0 else -1
    return at
