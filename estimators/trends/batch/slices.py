"""A slice of series, from the caller's columns to the rows of the table."""

from __future__ import annotations

import numpy as np

from estimators.arrays import BoolArray, IntArray
from estimators.consensus.cancellation import Cancelled, cancel_flag
from estimators.consensus.found import Search
from estimators.consensus.presets import PRESETS
from estimators.consensus.search.sampling import SamplingSearch
from estimators.consensus.search.structure import LEAST_POINTS, StructureSearch
from estimators.trends.batch.columns import Columns
from estimators.trends.batch.conclude import conclude
from estimators.trends.batch.group import Group, Known
from estimators.trends.batch.lines import find_consensus, find_structures
from estimators.trends.batch.ready import make_ready
from estimators.trends.batch.rivals import find_ambiguous
from estimators.trends.batch.scales import measure_group

_POINTS, _SERIES = 65_536, 1_024
"""A slice has no more, unless it is one series: its working memory is small beside any large input."""


def cut_slices(offsets: IntArray) -> list[tuple[int, int]]:
    """Cut a batch into slices ``first, last`` of about equal work.

    Examples
    --------
    >>> cut_slices(np.array([0, 40_000, 60_000, 200_000, 200_001]))
    [(0, 2), (2, 3), (3, 4)]
    """
    bounds = []
    first, series = 0, int(offsets.size) - 1
    while first < series:
        reach = int(np.searchsorted(offsets, offsets[first] + _POINTS, "right")) - 1
        last = min(max(reach, first + 1), first + _SERIES, series)
        bounds.append((first, last))
        first = last
    return bounds


def fit_slice(columns: Columns, first: int, last: int) -> None:
    """Fit series ``first .. last - 1`` and write their rows.

    Raises
    ------
    Cancelled
        If the caller's flag was set.
    """
    left = _fit_together(columns, first, last)
    flag = cancel_flag()
    for k in left.tolist():
        if flag[0]:
            raise Cancelled
        columns.write(k, columns.source.answer(k))


def _fit_together(columns: Columns, first: int, last: int) -> IntArray:
    """Fit what compiled code can fit side by side; returns the series that are left to be fitted alone."""
    source = columns.source
    asked = source.settings
    search = PRESETS[asked.method].search
    if asked.model != "line" or not asked.is_usual or not _is_compiled(search):
        return np.arange(first, last, dtype=np.int64)
    ready, left = make_ready(source, first, last)
    group = measure_group(ready, asked.sigma)
    needs_pilot = isinstance(search, SamplingSearch) and asked.threshold is None and asked.sigma is None
    least = LEAST_POINTS if needs_pilot or isinstance(search, StructureSearch) else 2
    group, left = _keep(group, group.ordinary & (group.lengths >= least), left)
    known = Known.told(asked, group.floor)
    if needs_pilot:
        pilot = find_structures(group, None, None, asked.options)
        group, left = _keep(group, pilot.found, left)
        known = Known.piloted(pilot.sigma[pilot.found], asked.options, group.floor)
    if isinstance(search, SamplingSearch):
        kept = columns.points is not None
        lines = find_consensus(group, search, known, asked.options, asked.seed, rate_points=kept)
    else:
        lines = find_structures(group, asked.sigma, asked.threshold, asked.options)
    if not lines.found.all():
        known = known.select(lines.found)
        lengths = group.lengths
        group, left = _keep(group, lines.found, left)
        lines = lines.select(lines.found, np.repeat(lines.found, lengths))
    if group.size:
        conclude(columns, group, lines, find_ambiguous(group, lines, known, asked))
    return left


def _keep(group: Group, kept: BoolArray, left: IntArray) -> tuple[Group, IntArray]:
    """Keep some series of a group; the others join those that are left."""
    return group.select(kept), np.concatenate([left, group.series[~kept]])


def _is_compiled(search: Search) -> bool:
    if isinstance(search, SamplingSearch):
        return search.execution == "compiled"
    return isinstance(search, StructureSearch)
