"""Influence of residuals on a model of any number of columns: the matrices of its sandwich variance.

A = sum psi' x x' and B = sum psi^2 x x' (Huber 1981), and the weight matrix W = sum (psi / u) x x'; what is
counted over the series alone is in :mod:`estimators.regression.influence`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import types

from estimators.arrays import FloatArray
from estimators.kernels import kernel, ro
from estimators.regression.influence import influence
from estimators.regression.loss import Loss

_f8 = types.float64
_EMPTY = np.empty(0)


@dataclass(frozen=True, slots=True)
class ColumnInfluence:
    """Matrices of a sandwich variance, in noise scales.

    Attributes
    ----------
    curvature, scatter, weight : ndarray of float64, shape (p, p)
        A, B and W.
    """

    curvature: FloatArray
    scatter: FloatArray
    weight: FloatArray


@kernel(
    types.void(
        ro(_f8, 2), ro(_f8), ro(_f8), _f8, types.int64, _f8, _f8, ro(_f8),
        _f8[:, ::1], _f8[:, ::1], _f8[:, ::1],
    )
)  # fmt: skip
def _fill_matrices(
    columns: FloatArray,
    residual: FloatArray,
    root_weight: FloatArray,
    sigma: float,
    kind: int,
    c: float,
    jump: float,
    table: FloatArray,
    curvature: FloatArray,
    scatter: FloatArray,
    weight: FloatArray,
) -> None:
    p, n = columns.shape
    curvature[:] = 0.0
    scatter[:] = 0.0
    weight[:] = 0.0
    weighted = root_weight.size > 0
    root = 1.0
    for i in range(n):
        if weighted:
            root = root_weight[i]
        psi, bend, pull = influence(kind, c, jump, table, residual[i] * root / sigma)
        square = root * root
        for j in range(p):
            for k in range(j + 1):
                product = columns[j, i] * columns[k, i] * square
                curvature[j, k] += bend * product
                scatter[j, k] += psi * psi * product
                weight[j, k] += pull * product
    for j in range(p):
        for k in range(j):
            curvature[k, j] = curvature[j, k]
            scatter[k, j] = scatter[j, k]
            weight[k, j] = weight[j, k]


@kernel(types.void(ro(_f8, 2), ro(_f8), _f8, _f8[:, ::1]))
def _fill_neighbours(
    columns: FloatArray, root_weight: FloatArray, correlation: float, products: FloatArray
) -> None:
    p, n = columns.shape
    products[:] = 0.0
    before = np.zeros(p)
    for i in range(n):
        for j in range(p):
            before[j] *= correlation
        for j in range(p):
            for k in range(p):
                products[j, k] += columns[j, i] * root_weight[i] * before[k]
        for j in range(p):
            before[j] += columns[j, i] * root_weight[i]
    for j in range(p):
        for k in range(j + 1):
            both = products[j, k] + products[k, j]
            products[j, k] = both
            products[k, j] = both


def neighbour_products(columns: FloatArray, root_weight: FloatArray, correlation: float) -> FloatArray:
    """Sum x_i x_j' rho^|i - j| over all pairs of different points.

    What correlated neighbours add to the scatter of a fit: much for columns that change slowly, next to
    nothing for those that swing faster than the correlation lasts.

    Parameters
    ----------
    columns : ndarray of float64, shape (p, n), C-contiguous
    root_weight : ndarray of float64, shape (n,)
        Square roots of the precisions; 0 for points that carry no correlation along.
    correlation : float
        rho, of neighbours.

    Returns
    -------
    ndarray of float64, shape (p, p)

    Examples
    --------
    >>> neighbour_products(np.ones((1, 3)), np.ones(3), 0.5)
    array([[2.5]])
    """
    p = columns.shape[0]
    products = np.empty((p, p))
    _fill_neighbours(columns, root_weight, correlation, products)
    return products


def column_influence(
    columns: FloatArray, residual: FloatArray, root_weight: FloatArray | None, sigma: float, loss: Loss
) -> ColumnInfluence:
    """Sum the matrices over a fitted series.

    Parameters
    ----------
    columns : ndarray of float64, shape (p, n), C-contiguous
    residual : ndarray of float64, shape (n,)
    root_weight : ndarray of float64, shape (n,), or None
        Square roots of the precisions.
    sigma : float
    loss : Loss
        What the model minimises at this scale.

    Returns
    -------
    ColumnInfluence

    Examples
    --------
    >>> from estimators.regression.loss import LossKind
    >>> columns = np.vstack([np.ones(3), [-1.0, 0.0, 1.0]])
    >>> column_influence(columns, np.array([0.1, -0.2, 0.1]), None, 0.1, Loss(LossKind.square)).scatter
    array([[6., 0.],
           [0., 2.]])
    """
    p = columns.shape[0]
    made = ColumnInfluence(np.empty((p, p)), np.empty((p, p)), np.empty((p, p)))
    _fill_matrices(
        columns, residual, _EMPTY if root_weight is None else root_weight, sigma, int(loss.kind), loss.tuning,
        loss.jump, _EMPTY if loss.table is None else loss.table, made.curvature, made.scatter, made.weight,
    )  # fmt: skip
    return made
