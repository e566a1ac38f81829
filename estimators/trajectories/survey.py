"""What is known of every row before any answer is written: reason, inlier, and whether the track moves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from estimators.arrays import BoolArray, CodeArray, FloatArray
from estimators.trajectories.course import Course
from estimators.trajectories.labelling.modes import ADRIFT, LEVEL_STRIDE, SPIKE
from estimators.trajectories.motion import half_span, is_displaced, without_short
from estimators.trajectories.parameters import TrackParameters
from estimators.trajectories.reasons import FixReason
from estimators.trajectories.rows import Rows
from estimators.trajectories.smoothing.blocks import BLOCK
from estimators.trajectories.smoothing.uncertainty import BURSTS
from estimators.trajectories.stale import runs_of

_STALE_GATE = 9.21
"""99 % of chi-square with two degrees of freedom."""
_GAP_STEPS = 10.0
_GAP_M = 100.0
"""A gap is ten steps long or longer, and leaves the position that uncertain."""
_FEW = 5


@dataclass(frozen=True, slots=True)
class Survey:
    """One entry per row that has a time, in order of time.

    Attributes
    ----------
    codes : ndarray of uint8, shape (m,)
        :class:`FixReason`.
    inlier : ndarray of bool, shape (m,)
    repeats_good : ndarray of bool, shape (m,)
        Whether a row, were it sound, would be an inlier: what the probability of a repeated position is.
    moving : ndarray of bool, shape (m,)
    gaps : int
    """

    codes: CodeArray
    inlier: BoolArray
    repeats_good: BoolArray
    moving: BoolArray
    gaps: int


def survey(course: Course, typical_step_s: float) -> Survey:
    """Look at the whole track once; a gap is long against the typical step."""
    rows = course.rows
    m = rows.t.size
    half = half_span(course.typical_sigma())
    codes, moving = np.zeros(m, dtype=np.uint8), np.zeros(m, dtype=np.bool_)
    off = np.zeros(m, dtype=np.bool_)
    for part in course.parts():
        wide = course.around(part, half)
        view = course.view(wide)
        own = slice(part.start - wide.start, part.stop - wide.start)
        moving[part] = is_displaced(rows.t[wide], view.places, np.sqrt(view.variance), half)[own]
        off[part] = (view.residual**2 > _STALE_GATE * (view.variance + view.solved.variance))[own]
        kind = course.labels[part] % LEVEL_STRIDE
        codes[part][kind == SPIKE] = FixReason.spike
        codes[part][np.isin(kind, (*BURSTS, ADRIFT))] = FixReason.burst
    gaps = find_gaps(rows.t, typical_step_s, course.labelled.parameters)
    _mark_whole(codes, rows, off, gaps)
    inlier = (codes == FixReason.ok) | (codes == FixReason.gap_edge)
    # A duplicate is what its twin is, and so is its label; its reason stays.
    inlier[rows.duplicates] = inlier[rows.twins]
    good = inlier.copy()
    for part in course.parts():
        known = rows.codes[rows.inputs(part)]
        inlier[part] &= (known != FixReason.invalid) & (known != FixReason.out_of_order)
        codes[part] = np.where(known == FixReason.ok, codes[part], known)
    return Survey(codes, inlier, good, without_short(rows.t, moving, half), len(gaps))


def find_gaps(t: FloatArray, typical_s: float, parameters: TrackParameters) -> list[int]:
    """Places after which there is a gap."""
    if t.size <= _FEW:
        return []
    found: list[int] = []
    for first in range(0, t.size - 1, BLOCK):
        steps = np.diff(t[first : first + BLOCK + 1])
        hidden = np.sqrt(parameters.manoeuvre * steps**3 / 3.0)
        found += (first + np.flatnonzero((steps > _GAP_STEPS * typical_s) & (hidden > _GAP_M))).tolist()
    return found


def _mark_whole(codes: CodeArray, rows: Rows, off: BoolArray, gaps: list[int]) -> None:
    """Write the reasons that are those of several rows together."""
    for first, stop in runs_of(rows.repeat):
        if off[first:stop].any():
            codes[first:stop] = FixReason.stale
    for place in gaps:
        for edge in (place, place + 1):
            if codes[edge] == FixReason.ok:
                codes[edge] = FixReason.gap_edge
