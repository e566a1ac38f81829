"""The uncertainty of a trend of columns: by formula, or by the method that was asked for."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from estimators.arrays import FloatArray, InputError
from estimators.consensus.found import Found, LinearData
from estimators.inference.columns import ColumnUncertainty, column_uncertainty
from estimators.inference.scores import point_scores
from estimators.inference.spread import uncorrelated_axes
from estimators.regression.influence import influence_sums
from estimators.trends.bases.curve import weighted_sum
from estimators.trends.bases.design import Design
from estimators.trends.bases.parameters import polynomial_directions
from estimators.trends.request import Request
from estimators.trends.resampling import Fitted, Inferred, Refit, Scored, infer

_PROBES = 200
"""Readings, spread over the series, at which two curves are compared."""


@dataclass(frozen=True, slots=True)
class FittedColumns:
    """A fit of columns and the sums over its readings that its uncertainty is made from.

    Attributes
    ----------
    data : LinearData
    found : Found
    sums : ndarray of float64
        From :func:`estimators.regression.influence.influence_sums`.
    """

    data: LinearData
    found: Found
    sums: FloatArray

    @classmethod
    def of(cls, data: LinearData, found: Found) -> FittedColumns:
        """Take the sums that the search made, or make them."""
        sums = found.sums
        if sums is None:
            root = None if data.weights is None else np.sqrt(data.weights)
            sums = influence_sums(
                data.t, data.y, found.residual, root, found.sigma, found.threshold, found.loss
            )
        return cls(data, found, sums)

    def spread(self, *, correct: bool) -> ColumnUncertainty | None:
        """Uncertainty by formula, serial correlation included or not."""
        root = None if self.data.weights is None else np.sqrt(self.data.weights)
        return column_uncertainty(
            self.data.columns, self.found, root, self.sums, correct_serial_correlation=correct
        )


def check_uncertainty(request: Request, model: str, degree: int) -> None:
    """Refuse to test the trend of a shape that has none.

    Raises
    ------
    InputError
        If ``permutation`` is asked of a level.
    """
    if request.uncertainty == "permutation" and degree == 0:
        raise InputError(
            "uncertainty",
            f"permutation counts the p-value of a trend, and the model {model} of degree 0 has none; use "
            "effective-n, hac or bootstrap for the interval of its level",
        )


def infer_columns(
    request: Request, design: Design, fit: FittedColumns, again: Callable[[FloatArray], FittedColumns | None]
) -> Inferred[ColumnUncertainty]:
    """Uncertainty of a trend of columns by the method asked for.

    Parameters
    ----------
    request : Request
    design : Design
        Of the fit; resampled series are fitted with the same columns.
    fit : FittedColumns
    again : callable
        Fits other values at the same times; None where they show no structure.

    Returns
    -------
    Inferred
    """
    correct = request.options.correct_serial_correlation
    spread = fit.spread(correct=correct)
    independent = fit.spread(correct=False)
    if spread is None or independent is None or request.uncertainty == "effective-n":
        return Inferred(spread)
    data, found = fit.data, fit.found
    root = None if data.weights is None else np.sqrt(data.weights)
    probes = np.ascontiguousarray(data.columns[:, :: max(1, -(-data.n // _PROBES))])

    def refit(values: FloatArray) -> Refit[ColumnUncertainty] | None:
        replicate = again(values)
        own = None if replicate is None else replicate.spread(correct=correct)
        if replicate is None or own is None:
            return None
        theta = replicate.found.theta
        return Refit(theta, own, weighted_sum(probes, theta), replicate.found.sigma)

    fitted = Fitted(
        y=data.y,
        residual=found.residual,
        beside=_beside(design, data, found.theta),
        root=root,
        fit=Refit(found.theta, spread, weighted_sum(probes, found.theta), found.sigma),
        axes=uncorrelated_axes(independent.plain, _tested(design)),
        stderr=spread.stderr(probes.T),
        has_trend=design.degree > 0,
        independent=lambda: independent,
        scored=lambda: Scored(
            data.t, point_scores(found.residual, root, found.sigma, found.loss), data.columns, root
        ),
        again=refit,
    )
    return infer(fitted, request.uncertainty, request.level, request.options.resamples, request.seed)


def _tested(design: Design) -> FloatArray:
    """Find the combination of coefficients that is tested: the mean slope, or else the level."""
    if design.degree > 0:
        return polynomial_directions(design, 0.0, "intercept")["slope"]
    first = np.zeros(design.size)
    first[0] = 1.0
    return first


def _beside(design: Design, data: LinearData, theta: FloatArray) -> FloatArray:
    """Seasons and own columns; of weighted values, whose noise is permuted alone, the level too."""
    kept = theta.copy()
    kept[design.polynomial] = 0.0
    if data.weights is not None:
        kept[0] = theta[0]
    return weighted_sum(data.columns, kept)
