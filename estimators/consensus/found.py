"""What goes into a search and what comes out of it: :class:`LinearData` and :class:`Found`.

Every preset, sampled or closed, is a ``Search``: a policy object with ``run(data, scale, options, seed)``
that returns :class:`Found`. The engine knows no names of methods.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from estimators.arrays import BoolArray, FloatArray
from estimators.options import RobustOptions
from estimators.regression.group_uncertainty import GroupUncertainty
from estimators.regression.loss import Loss
from estimators.result import Ledger, NoFit, SearchKind


@dataclass(frozen=True)
class LinearData:
    """Data of a linear model in its normalising frame.

    The frame maps time to [-1, 1] and leaves the values in their own units; it is made and undone by
    :mod:`estimators.trends`.

    Attributes
    ----------
    columns : ndarray of float64, shape (p, n), C-contiguous
        Design, one row per coefficient; for a line ``[1, t]``.
    y : ndarray of float64, shape (n,)
    t : ndarray of float64, shape (n,)
        Time in the frame, ascending; what far-apart sampling and serial correlation look at.
    weights : ndarray of float64, shape (n,), or None
        Precisions with mean 1.
    """

    columns: FloatArray
    y: FloatArray
    t: FloatArray
    weights: FloatArray | None

    @property
    def n(self) -> int:
        """Number of points."""
        return int(self.y.size)

    @property
    def p(self) -> int:
        """Number of coefficients, which is the size of a minimal sample."""
        return int(self.columns.shape[0])


class LineData(LinearData):
    """Data of a line; its design ``[1, t]`` is made only for the methods that read it.

    Parameters
    ----------
    t, y : ndarray of float64, shape (n,)
        Time in the frame, values.
    weights : ndarray of float64, shape (n,), or None
    """

    def __init__(self, t: FloatArray, y: FloatArray, weights: FloatArray | None) -> None:
        # The parent is frozen, and `columns` stays unset until the property below is asked for it.
        object.__setattr__(self, "t", t)
        object.__setattr__(self, "y", y)
        object.__setattr__(self, "weights", weights)

    @property
    def columns(self) -> FloatArray:
        """Design, shape (2, n)."""
        made: FloatArray | None = self.__dict__.get("_columns")
        if made is None:
            made = np.empty((2, self.t.size))
            made[0] = 1.0
            made[1] = self.t
            self.__dict__["_columns"] = made
        return made

    @property
    def p(self) -> int:
        """A line has two coefficients."""
        return 2


@dataclass(frozen=True, slots=True)
class Scale:
    """Noise scale and threshold known before the search, in the frame's units.

    Attributes
    ----------
    sigma : float or None
    sigma_source : str
    threshold : float or None
        Bound on |residual| * sqrt(weight) of an inlier.
    threshold_source : {"given", "sigma"}
    floor : float
        Smallest scale the arithmetic and the quantisation of the values allow; never 0.
    """

    sigma: float | None
    sigma_source: str
    threshold: float | None
    threshold_source: str
    floor: float


@dataclass(frozen=True, slots=True)
class OtherStructure:
    """A competing structure, in the frame's units.

    Attributes
    ----------
    theta : ndarray of float64, shape (p,)
    sigma : float
    inliers : int
        Points that follow it and not the model found.
    margin : float
        Log evidence by which the model found is preferred.
    """

    theta: FloatArray
    sigma: float
    inliers: int
    margin: float


@dataclass(frozen=True, slots=True)
class Found:
    """Result of a search, in the frame's units.

    Attributes
    ----------
    theta : ndarray of float64, shape (p,)
    residual : ndarray of float64, shape (n,)
        Signed, ``y - theta @ columns``.
    inlier : ndarray of bool, shape (n,)
        ``|residual| * sqrt(weight) <= threshold``.
    probability : ndarray of float64, shape (n,), or None
        Posterior inlier probability where the search makes one itself.
    sigma, threshold : float
    sigma_source, threshold_source : str
    loss : Loss
        What ``theta`` minimises at scale ``sigma``.
    ledger : Ledger
    sampling_probability : float or None
    search : {"sampled", "exhaustive", "certified", "closed"}
    runner_up : OtherStructure or None
        Another structure that the search met on its way.
    sums : ndarray of float64, or None
        Sums of :mod:`estimators.regression.influence`, where the search made them on its last pass.
    spread : GroupUncertainty or None
        Covariance of ``theta`` for independent points, where the loss does not tell it.
    """

    theta: FloatArray
    residual: FloatArray
    inlier: BoolArray
    probability: FloatArray | None
    sigma: float
    sigma_source: str
    threshold: float
    threshold_source: str
    loss: Loss
    ledger: Ledger
    sampling_probability: float | None
    search: SearchKind
    runner_up: OtherStructure | None = None
    sums: FloatArray | None = None
    spread: GroupUncertainty | None = None


class Search(Protocol):
    """A way from data to a model. Policies hold their settings as frozen fields."""

    @property
    def needs_threshold(self) -> bool:
        """Whether ``scale.threshold`` must be known before the search."""
        ...

    def run(self, data: LinearData, scale: Scale, options: RobustOptions, seed: int) -> Found | NoFit:
        """Find the model. Pure: the same arguments give the same bytes."""
        ...
