"""Typed warnings: what a caller should know about an answer, one code and one sentence each."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any


class NoticeCode(StrEnum):
    """Typed warnings: each has one meaning and one sentence, in :data:`NOTICE_MEANINGS`."""

    few_points = "few_points"
    no_redundancy = "no_redundancy"
    ambiguous_structure = "ambiguous_structure"
    low_inlier_ratio = "low_inlier_ratio"
    low_sampling_probability = "low_sampling_probability"
    serial_correlation = "serial_correlation"
    quantised_values = "quantised_values"
    zero_noise = "zero_noise"
    constant_values = "constant_values"
    duplicate_times = "duplicate_times"
    unsorted_times = "unsorted_times"
    missing_values = "missing_values"
    invalid_values = "invalid_values"
    float_nanoseconds = "float_nanoseconds"
    extrapolation = "extrapolation"
    not_robust = "not_robust"
    earlier_regimes = "earlier_regimes"
    nonpositive_values = "nonpositive_values"
    undetermined_noise = "undetermined_noise"
    rate_near_zero = "rate_near_zero"
    ambiguous_faults = "ambiguous_faults"
    unchecked_position = "unchecked_position"
    untestable_satellites = "untestable_satellites"
    unbounded_error = "unbounded_error"
    inconsistent_ranges = "inconsistent_ranges"
    satellites_below_mask = "satellites_below_mask"
    few_fixes = "few_fixes"
    drift_unobservable = "drift_unobservable"
    sampling_too_sparse = "sampling_too_sparse"
    mostly_faulty = "mostly_faulty"
    clock_jumped = "clock_jumped"
    stale_positions = "stale_positions"
    long_gaps = "long_gaps"
    invalid_rows = "invalid_rows"


NOTICE_MEANINGS: Mapping[NoticeCode, str] = {
    NoticeCode.few_points: "So few points that outliers can hardly be told from inliers.",
    NoticeCode.no_redundancy: (
        "The line passes through the points exactly; there is no uncertainty to report."
    ),
    NoticeCode.ambiguous_structure: "Another trend explains the series nearly as well; both are reported.",
    NoticeCode.low_inlier_ratio: "Fewer than half of the points follow the trend.",
    NoticeCode.low_sampling_probability: "The hypotheses drawn may have missed a clean sample.",
    NoticeCode.serial_correlation: (
        "Neighbouring residuals are correlated; intervals are widened accordingly."
    ),
    NoticeCode.quantised_values: "The values are rounded coarsely compared with their noise.",
    NoticeCode.zero_noise: ("The points lie exactly on the trend; the noise scale is set by the arithmetic."),
    NoticeCode.constant_values: "All values are equal.",
    NoticeCode.duplicate_times: "Several points share a time; they are all used.",
    NoticeCode.unsorted_times: "The times were not in order; the answer keeps the order of the input.",
    NoticeCode.missing_values: "Rows with a missing time or value take no part in the fit.",
    NoticeCode.invalid_values: "Rows with an infinite time or value take no part in the fit.",
    NoticeCode.float_nanoseconds: "Epoch nanoseconds as floats are 256 ns apart; send integers or datetimes.",
    NoticeCode.extrapolation: "Some predictions lie outside the time span of the data.",
    NoticeCode.not_robust: "This method is offered for comparison; outliers can move it.",
    NoticeCode.earlier_regimes: (
        "The series followed other lines before; the trend is that of the present regime."
    ),
    NoticeCode.nonpositive_values: (
        "Values of 0 or of the other sign cannot occur under multiplicative noise; they are left out."
    ),
    NoticeCode.undetermined_noise: (
        "The data tell neither multiplicative from additive noise; both answers are reported."
    ),
    NoticeCode.rate_near_zero: (
        "The interval of the rate holds 0; a doubling or halving time has no upper limit."
    ),
    NoticeCode.ambiguous_faults: (
        "Other sets of faulty satellites explain the ranges nearly as well, and lead elsewhere."
    ),
    NoticeCode.unchecked_position: (
        "As many satellites as unknowns: a faulty one would go unnoticed and move the position."
    ),
    NoticeCode.untestable_satellites: "Nothing checks the ranges of some satellites.",
    NoticeCode.unbounded_error: (
        "Faults that no range contradicts are likelier than the integrity risk: no level bounds the error."
    ),
    NoticeCode.inconsistent_ranges: "The ranges that are used disagree by more than their noise.",
    NoticeCode.satellites_below_mask: "Satellites under the elevation mask take no part.",
    NoticeCode.few_fixes: "So few fixes that faults can hardly be told from motion.",
    NoticeCode.drift_unobservable: (
        "Errors that change slowly look like motion; what the positions share of them stays in the track."
    ),
    NoticeCode.sampling_too_sparse: (
        "Between two fixes the track can go farther than faults are large; small faults go unnoticed."
    ),
    NoticeCode.mostly_faulty: "A large share of the fixes disagrees with the track that the others make.",
    NoticeCode.clock_jumped: "The clock jumped there and back; rows between are put where the file has them.",
    NoticeCode.stale_positions: "Some rows repeat an old position while the track moves on.",
    NoticeCode.long_gaps: "There are gaps over which the motion cannot be foretold.",
    NoticeCode.invalid_rows: "Rows without a time, or without a place on Earth, take no part.",
}


POSITION_NOTICES = frozenset(
    {
        NoticeCode.ambiguous_faults,
        NoticeCode.unchecked_position,
        NoticeCode.untestable_satellites,
        NoticeCode.unbounded_error,
        NoticeCode.inconsistent_ranges,
        NoticeCode.satellites_below_mask,
    }
)
"""Notices that only positions give."""

TRACK_NOTICES = frozenset(
    {
        NoticeCode.few_fixes,
        NoticeCode.drift_unobservable,
        NoticeCode.sampling_too_sparse,
        NoticeCode.mostly_faulty,
        NoticeCode.clock_jumped,
        NoticeCode.stale_positions,
        NoticeCode.long_gaps,
        NoticeCode.invalid_rows,
    }
)
"""Notices that only tracks give."""


@dataclass(frozen=True, slots=True)
class Notice:
    """A typed warning in an answer.

    Attributes
    ----------
    code : NoticeCode
    message : str
        A sentence for people.
    detail : mapping
        Numbers behind the sentence (JSON-safe).
    """

    code: NoticeCode
    message: str
    detail: Mapping[str, Any] = field(default_factory=dict)


def notice(code: NoticeCode, **detail: Any) -> Notice:
    """Notice with the standard sentence of its code."""
    return Notice(code, NOTICE_MEANINGS[code], detail)


def notice_to_dict(item: Notice) -> dict[str, Any]:
    """JSON-safe form of a notice."""
    return {"code": item.code.value, "message": item.message, "detail": dict(item.detail)}
