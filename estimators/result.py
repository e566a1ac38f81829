"""What every answer shares: estimates with uncertainty, labels per point, the ledger, notices, and NoFit.

Plain frozen data; nothing here computes. The service mirrors these classes on the wire (DESIGN: "The
verbs and their answers").
"""

from __future__ import annotations

import html
from dataclasses import dataclass, field
from enum import StrEnum
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from estimators.arrays import BoolArray, CodeArray, FloatArray, Reason
from estimators.notices import Notice, notice_to_dict

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True, slots=True)
class Estimate:
    """A number with its uncertainty.

    Attributes
    ----------
    value : float
    stderr, low, high : float or None
        Standard error and confidence limits; None where the data leave no way to tell.
    """

    value: float
    stderr: float | None
    low: float | None
    high: float | None

    def scaled(self, factor: float) -> Estimate:
        """State the same estimate in another unit.

        Parameters
        ----------
        factor : float
            Positive; by which every number is multiplied.

        Returns
        -------
        Estimate

        Examples
        --------
        >>> Estimate(2.0, 0.5, 1.0, 3.0).scaled(10.0)
        Estimate(value=20.0, stderr=5.0, low=10.0, high=30.0)
        """

        def times(number: float | None) -> float | None:
            return None if number is None else number * factor

        return Estimate(self.value * factor, times(self.stderr), times(self.low), times(self.high))


@dataclass(frozen=True, slots=True)
class Points:
    """One entry per input row, in input order.

    Attributes
    ----------
    inlier : ndarray of bool, shape (n,)
    probability : ndarray of float64, shape (n,)
        Probability that the row follows the trend; NaN for rows outside the fit (``null`` on the wire).
    residual : ndarray of float64, shape (n,)
        Value minus trend; NaN for rows outside the fit.
    reason_codes : ndarray of uint8, shape (n,)
        Codes of :class:`estimators.arrays.Reason`.
    """

    inlier: BoolArray
    probability: FloatArray
    residual: FloatArray
    reason_codes: CodeArray

    @property
    def reason(self) -> list[str]:
        """Reasons by name, one per input row."""
        names = [member.name for member in Reason]
        return [names[code] for code in self.reason_codes]


@dataclass(frozen=True, slots=True)
class Ledger:
    """What the search did: it reproduces the reported sampling probability.

    Attributes
    ----------
    drawn : int
        Minimal samples drawn (or enumerated), degenerate ones included.
    degenerate : int
        Samples refused before solving.
    invalid : int
        Models refused after solving.
    scored : int
        Models scored, completely or until a lossless bound refused them.
    point_evaluations : int
        Residuals computed while scoring.
    optimizations : int
        Runs of local optimisation.
    """

    drawn: int = 0
    degenerate: int = 0
    invalid: int = 0
    scored: int = 0
    point_evaluations: int = 0
    optimizations: int = 0


SearchKind = Literal["sampled", "exhaustive", "certified", "closed"]


@dataclass(frozen=True, slots=True)
class Consensus:
    """What the algorithm did to get to the answer.

    Attributes
    ----------
    method : str
        Preset.
    n : int
        Points that took part.
    inliers : int
    inlier_ratio : float
    threshold : float
        Largest |residual| of an inlier, in units of the values (before weighting).
    threshold_source : {"given", "sigma"}
    sigma : float
        Noise scale of an inlier of mean weight, in units of the values.
    sigma_source : {"given", "mixture", "residuals", "s-estimate", "floor"}
    ledger : Ledger
    sampling_probability : float or None
        Probability that at least one all-inlier sample was among those drawn, exact (hypergeometric;
        METHODS.md 2.2). It is not the probability that the fit is right. None for closed methods.
    search : {"sampled", "exhaustive", "certified", "closed"}
        ``closed``: the method draws no samples.
    seed : int
    """

    method: str
    n: int
    inliers: int
    inlier_ratio: float
    threshold: float
    threshold_source: str
    sigma: float
    sigma_source: str
    ledger: Ledger
    sampling_probability: float | None
    search: SearchKind
    seed: int


@dataclass(frozen=True, slots=True)
class Uncertainty:
    """How the intervals of an answer were made.

    Attributes
    ----------
    method : str
        ``"effective-n"``, ``"hac"``, ``"bootstrap"``, ``"permutation"``, ``"sandwich"``, ``"jackknife"`` or
        ``"none"`` (nothing left to estimate it from).
    level : float
        Confidence level of every interval in the answer.
    effective_n : float or None
        Number of independent inliers that the correlated ones are worth.
    lag1 : float or None
        Bias-corrected lag-1 correlation of the residuals' scores.
    dof : float or None
        Degrees of freedom of Student's t.
    resamples : int or None
        Series that were fitted again, where the method does that.
    block : int or None
        Neighbouring points that were drawn together.
    stability : float or None
        Share of resampled series in which the procedure found the same structure again.
    """

    method: str
    level: float
    effective_n: float | None
    lag1: float | None
    dof: float | None
    resamples: int | None = None
    block: int | None = None
    stability: float | None = None


class NoFitReason(StrEnum):
    """Why there is no model."""

    no_data = "no_data"
    too_few_points = "too_few_points"
    constant_time = "constant_time"
    no_consensus = "no_consensus"
    too_large = "too_large"
    invalid_input = "invalid_input"
    too_few_satellites = "too_few_satellites"
    undetermined_geometry = "undetermined_geometry"
    implausible_position = "implausible_position"


@dataclass(frozen=True, slots=True)
class NoFit:
    """No model, and why. Falsy, so that ``if trend:`` reads as it should.

    Attributes
    ----------
    reason : NoFitReason
    message : str
        A sentence that says how to mend it.
    points : Points
        One entry per input row, as in an answer.
    notices : tuple of Notice
    time, values : ndarray or None
        The caller's series as numbers or datetime64[ns], in input order, for frames.
    """

    reason: NoFitReason
    message: str
    points: Points
    notices: tuple[Notice, ...] = ()
    time: np.ndarray[Any, Any] | None = field(default=None, repr=False)
    values: FloatArray | None = field(default=None, repr=False)

    def __bool__(self) -> bool:
        return False

    def summary(self) -> str:
        """Text for people: the reason and the warnings."""
        told = [f"Note: {item.message}" for item in self.notices]
        return "\n".join([f"No fit ({self.reason.value}): {self.message}", *told])

    def to_dict(self) -> dict[str, Any]:
        """JSON-safe form."""
        return {
            "fit": None,
            "reason": self.reason.value,
            "message": self.message,
            "points": {"reason": self.points.reason},
            "notices": [notice_to_dict(item) for item in self.notices],
        }

    def to_frame(self) -> pd.DataFrame:
        """One row per input row: what there is of time and value, inlier, probability, residual, reason.

        Raises
        ------
        ImportError
            If pandas is not installed (extra ``[pandas]``).
        """
        import pandas as pd  # noqa: PLC0415

        names = pd.Index([member.name for member in Reason])
        columns: dict[str, Any] = {"time": self.time, "value": self.values}
        columns |= {
            "inlier": self.points.inlier,
            "probability": self.points.probability,
            "residual": self.points.residual,
            "reason": pd.Categorical.from_codes(self.points.reason_codes.astype(np.int8), categories=names),
        }
        return pd.DataFrame({name: column for name, column in columns.items() if column is not None})

    def _repr_html_(self) -> str:
        notes = "".join(f"<li>{html.escape(item.message)}</li>" for item in self.notices)
        listed = f"<ul>{notes}</ul>" if notes else ""
        return f"<p><b>No fit</b> ({self.reason.value}): {html.escape(self.message)}</p>{listed}"
