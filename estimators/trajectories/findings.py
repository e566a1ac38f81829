"""What is counted on the way through a track, and the notices that follow from it."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from estimators.arrays import FloatArray
from estimators.notices import Notice, NoticeCode, notice
from estimators.trajectories.measured_rows import MeasuredRows
from estimators.trajectories.parameters import TrackParameters
from estimators.trajectories.reasons import FixReason
from estimators.trajectories.rows import Rows
from estimators.trajectories.survey import Survey

_FEW = 5
_MOSTLY = 0.3
_COLOURED = 0.5
_SPARSE = 2.0


@dataclass(frozen=True, slots=True)
class Ledger:
    """What is known of a track before it is labelled.

    Attributes
    ----------
    measured : MeasuredRows
    unit, measured_unit : float
        Median radius that the receiver reports: of all rows, and of those that measure something; 1 without.
    step_s, row_step_s : float
        Median time between two fixes, and between two rows; 0 of one.
    """

    measured: MeasuredRows
    unit: float
    measured_unit: float
    step_s: float
    row_step_s: float

    def notices(self, parameters: TrackParameters, found: Survey, rows: Rows) -> tuple[Notice, ...]:
        """Say what is worth knowing."""
        told = []
        m = self.measured.size
        # Comparisons take a byte per row, np.bincount eight.
        counts = {reason: int(np.count_nonzero(found.codes == reason)) for reason in FixReason}
        bad = counts[FixReason.spike] + counts[FixReason.burst] + counts[FixReason.stale]
        sigma = parameters.sigma * self.measured_unit
        if m < _FEW:
            told.append(notice(NoticeCode.few_fixes, fixes=m))
        if bad > _MOSTLY * found.codes.size:
            told.append(notice(NoticeCode.mostly_faulty, share=round(bad / found.codes.size, 3)))
        # Where most fixes count as faulty, errors that last pass for the motion.
        if m >= _FEW and (parameters.colour_m > _COLOURED * sigma or bad > _MOSTLY * found.codes.size):
            told.append(notice(NoticeCode.drift_unobservable, coloured_m=parameters.colour_m))
        if m >= _FEW:
            hidden = math.sqrt(parameters.manoeuvre * self.step_s**3 / 3.0)
            if hidden > _SPARSE * sigma:
                told.append(notice(NoticeCode.sampling_too_sparse, step_s=self.step_s, hidden_m=hidden))
        if counts[FixReason.stale]:
            told.append(notice(NoticeCode.stale_positions, rows=counts[FixReason.stale]))
        shifted = int(np.count_nonzero(rows.codes == FixReason.out_of_order))
        if shifted:
            told.append(notice(NoticeCode.clock_jumped, rows=shifted))
        if found.gaps:
            told.append(notice(NoticeCode.long_gaps, gaps=found.gaps))
        invalid = int(np.count_nonzero(rows.codes == FixReason.invalid))
        if invalid:
            told.append(notice(NoticeCode.invalid_rows, rows=invalid))
        if not rows.was_sorted:
            told.append(notice(NoticeCode.unsorted_times))
        return tuple(told)


def open_ledger(rows: Rows, measured: MeasuredRows) -> Ledger:
    """Count what there is before labelling, when there is memory for it."""
    unit = measured_unit = 1.0
    if rows.reported is not None:
        unit = float(np.median(rows.reported))
        measured_unit = float(np.median(rows.reported[rows.measures]))
    row_step = _median_step(rows.t)
    step = row_step if rows.measures.all() else _median_step(rows.t[rows.measures])
    return Ledger(measured, unit, measured_unit, step, row_step)


def _median_step(t: FloatArray) -> float:
    return float(np.median(np.diff(t), overwrite_input=True)) if t.size > 1 else 0.0
