"""Variance of a robust model of any number of columns: the line's sandwich (:mod:`.sandwich`) in matrices."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import numpy as np

from estimators.arrays import FloatArray
from estimators.consensus.found import Found
from estimators.inference.sandwich import LEAST_DOF, sandwich
from estimators.inference.spread import covariance_from_axes
from estimators.regression.column_influence import column_influence, neighbour_products
from estimators.regression.influence import INLIERS, PSI_SQUARE, SUPPORT

_USED_UP = 2.0
"""Readings that a scale and the choice of inliers use up, beside one per coefficient."""
_DOF_SHARE = 0.4
"""Degrees of freedom that an effective inlier adds, as for a line."""
_LEAST_CURVATURE = 0.05
"""Curvature, as a share of the weights', below which the weights are the safer one."""


@dataclass(frozen=True, slots=True)
class ColumnUncertainty:
    """Uncertainty of coefficients.

    Attributes
    ----------
    method : {"effective-n", "sandwich", "hac", "bootstrap", "permutation"}
    sandwich, plain : ndarray of float64, shape (p, p)
        Two covariances, of the residuals as they are and of residuals alike everywhere; the larger counts.
    effective_n : float
        Independent inliers that the correlated ones are worth.
    lag1 : float
        Bias-corrected lag-1 correlation, 0 if negative or not asked for.
    dof : float
        Degrees of freedom of Student's t.
    """

    method: str
    sandwich: FloatArray
    plain: FloatArray
    effective_n: float
    lag1: float
    dof: float

    def stderr(self, directions: FloatArray) -> FloatArray:
        """Compute standard errors of linear combinations of the coefficients.

        Parameters
        ----------
        directions : ndarray of float64, shape (k, p)

        Returns
        -------
        ndarray of float64, shape (k,)

        Examples
        --------
        >>> one = ColumnUncertainty("sandwich", np.eye(2), 4.0 * np.eye(2), 9.0, 0.0, 5.0)
        >>> one.stderr(np.array([[1.0, 0.0], [3.0, 4.0]]))
        array([ 2., 10.])
        """
        larger = np.maximum(_quadratic(directions, self.sandwich), _quadratic(directions, self.plain))
        return np.asarray(np.sqrt(np.maximum(larger, 0.0)), dtype=np.float64)

    def named(self, method: str) -> ColumnUncertainty:
        """Say that it goes by another method's name."""
        return dataclasses.replace(self, method=method)

    def along(
        self, axes: FloatArray, covariance: FloatArray, method: str, effective_n: float, dof: float
    ) -> ColumnUncertainty:
        """Exchange both covariances for one given along axes.

        Parameters
        ----------
        axes, covariance : ndarray of float64, shape (p, p)
            One axis per row.
        method : str
        effective_n, dof : float
        """
        own = covariance_from_axes(axes, covariance)
        return ColumnUncertainty(method, own, own, effective_n, self.lag1, dof)


def _quadratic(directions: FloatArray, matrix: FloatArray) -> FloatArray:
    """Compute d' M d of every direction, in a fixed order of summation."""
    total = np.zeros(directions.shape[0])
    for j in range(matrix.shape[0]):
        inner = np.zeros(directions.shape[0])
        for k in range(matrix.shape[0]):
            inner += matrix[j, k] * directions[:, k]
        total += directions[:, j] * inner
    return total


def column_uncertainty(
    columns: FloatArray,
    found: Found,
    root_weight: FloatArray | None,
    sums: FloatArray,
    *,
    correct_serial_correlation: bool = True,
) -> ColumnUncertainty | None:
    """Sandwich variance with the corrections of a line's.

    Correlated neighbours add rho^|i - j| psi_i psi_j to the scatter of the fit, so that slow columns are
    widened, as the line is, and fast ones, such as those of a season, hardly.

    Parameters
    ----------
    columns : ndarray of float64, shape (p, n)
    found : Found
    root_weight : ndarray of float64, shape (n,), or None
        Square roots of the precisions.
    sums : ndarray of float64
        From :func:`estimators.regression.influence.influence_sums`.
    correct_serial_correlation : bool
        Whether to take the correlation of neighbours into account (default True).

    Returns
    -------
    ColumnUncertainty or None
        None where no more inliers than coefficients are left to estimate it from.
    """
    p, n = columns.shape
    inliers = float(sums[INLIERS])
    if inliers <= p:
        return None
    sigma = found.sigma
    matrices = column_influence(columns, found.residual, root_weight, sigma, found.loss)
    *_, lag1, _, widen = sandwich(sums[: PSI_SQUARE + 1].tolist(), n, sigma, correct_serial_correlation)
    try:
        root = np.linalg.inv(np.linalg.cholesky(matrices.weight))
    except np.linalg.LinAlgError:
        return None
    curvature = matrices.curvature
    if float(np.linalg.eigvalsh(root @ curvature @ root.T)[0]) < _LEAST_CURVATURE:
        # Few points and a steep descent of psi: the weights themselves are the safer curvature.
        curvature = matrices.weight
    inverse = np.linalg.inv(curvature)
    carried = np.zeros((p, p))
    if lag1 > 0.0:
        roots = found.inlier.astype(np.float64) if root_weight is None else found.inlier * root_weight
        carried = neighbour_products(columns, roots, lag1) * (float(sums[PSI_SQUARE]) / inliers)
    used_up = p + _USED_UP
    support = max(float(sums[SUPPORT]), used_up)
    factor = sigma * support / max(support - used_up, 1.0)
    # Twice by the factor: squares of tiny values would underflow in a product of their own.
    return ColumnUncertainty(
        method="effective-n" if correct_serial_correlation else "sandwich",
        sandwich=(inverse @ (matrices.scatter + carried) @ inverse) * factor * factor,
        plain=(inverse @ (curvature + carried) @ inverse) * factor * factor,
        effective_n=max(support / widen, 1.0),
        lag1=lag1,
        dof=max(_DOF_SHARE * (support - p + 2.0) / widen - 1.0, LEAST_DOF),
    )
