"""Robust trends as a scikit-learn regressor (extra ``[sklearn]``).

One feature is a trend over that feature and takes the way of :func:`estimators.fit_trend`; several features
take the same searches on a design with one column each (:mod:`estimators.adapters.hyperplane`).
"""

from __future__ import annotations

from typing import Self

import numpy as np
from sklearn.base import BaseEstimator, RegressorMixin
from sklearn.utils import check_random_state
from sklearn.utils.validation import _check_sample_weight, check_is_fitted, validate_data

from estimators.adapters.hyperplane import Hyperplane, fit_hyperplane
from estimators.arrays import ArrayLike, FloatArray, InputError
from estimators.consensus.presets import PRESETS
from estimators.options import RobustOptions
from estimators.result import NoFit
from estimators.trends.arguments import check_fraction, check_positive, check_seed, look_up
from estimators.trends.fit import fit_trend
from estimators.trends.trend import Trend


class PlumblineRegressor(RegressorMixin, BaseEstimator):  # type: ignore[misc]  # scikit-learn has no types
    """Linear regression that outliers cannot move, without a threshold to choose.

    Parameters
    ----------
    method : str
        Preset; see :func:`estimators.methods` (default ``"auto"``). With several features ``auto`` is the
        MM-estimate, and methods that fit lines only are refused.
    threshold : float, optional
        Largest residual of an inlier, in units of ``y``.
    sigma : float, optional
        Noise scale of an inlier; estimated where it is not given.
    level : float
        Confidence level of ``interval_`` (default 0.95).
    random_state : int, RandomState instance or None
        Seed of methods that draw samples (default 0: the same data, the same answer).
    options : RobustOptions, optional
        Everything else about the search.

    Attributes
    ----------
    coef_ : ndarray of float64, shape (n_features,)
        0 for a feature that does not vary, or that depends linearly on those before it.
    intercept_ : float
    stderr_ : ndarray of float64, shape (n_features,)
        Standard errors of ``coef_``; NaN where the data leave no way to tell.
    interval_ : ndarray of float64, shape (n_features, 2)
        Confidence limits of ``coef_``.
    inlier_mask_ : ndarray of bool, shape (n_samples,)
        False also for rows of weight 0.
    inlier_probability_ : ndarray of float64, shape (n_samples,)
        Probability that the row follows the model; NaN for rows of weight 0.
    sigma_, threshold_ : float
        Noise scale of an inlier; largest residual of one.
    trend_ : Trend or None
        The whole answer of :func:`estimators.fit_trend`, with one feature.
    n_features_in_ : int
    feature_names_in_ : ndarray of str, shape (n_features_in_,)
        Where ``X`` has names of columns.

    Notes
    -----
    ``score`` is R2, as everywhere in scikit-learn, and outliers among the rows scored lower it; in a
    cross-validation of contaminated data take ``scoring="neg_median_absolute_error"``. Sample weights are
    precisions, 1/variance up to a common factor, so that a weight of 2 is not the same as a row given twice.
    With one feature, neighbours along it may be correlated (it is usually time) and the intervals allow for
    that; rows of several features are taken for independent.

    Examples
    --------
    >>> import numpy as np
    >>> from estimators.adapters.sklearn import PlumblineRegressor
    >>> random = np.random.RandomState(0)
    >>> X = random.uniform(size=(60, 2))
    >>> y = 1.0 + X @ [2.0, -3.0] + 0.01 * random.standard_normal(60)
    >>> y[:20] += 5.0
    >>> model = PlumblineRegressor().fit(X, y)
    >>> model.coef_.round(1), int((~model.inlier_mask_).sum())
    (array([ 2., -3.]), 20)
    """

    def __init__(
        self,
        method: str = "auto",
        *,
        threshold: float | None = None,
        sigma: float | None = None,
        level: float = 0.95,
        random_state: int | np.random.RandomState | None = 0,
        options: RobustOptions | None = None,
    ) -> None:
        self.method = method
        self.threshold = threshold
        self.sigma = sigma
        self.level = level
        self.random_state = random_state
        self.options = options

    def fit(self, X: ArrayLike, y: ArrayLike, sample_weight: ArrayLike | None = None) -> Self:
        """Fit the model.

        Parameters
        ----------
        X : array_like, shape (n_samples, n_features)
            Finite numbers.
        y : array_like, shape (n_samples,)
        sample_weight : array_like, shape (n_samples,), optional
            Precisions; 0 leaves a row out.

        Returns
        -------
        PlumblineRegressor
            Itself.

        Raises
        ------
        InputError
            If a parameter cannot be used. It is a ValueError.
        ValueError
            If the data are not what scikit-learn takes, or do not determine a model.
        """
        matrix, values = validate_data(self, X, y, dtype=np.float64, order="C", y_numeric=True)
        values = np.asarray(values, dtype=np.float64)
        weights = None
        if sample_weight is not None:
            weights = _check_sample_weight(sample_weight, matrix, dtype=np.float64, ensure_non_negative=True)
        features = matrix.shape[1]
        used = matrix if weights is None else matrix[weights > 0.0]
        if len(used) <= features:
            raise ValueError(
                f"a linear model of {features} feature(s) needs at least {features + 1} rows of positive "
                f"weight; there are n_samples = {len(used)}"
            )
        answer: Trend | Hyperplane | NoFit
        if features == 1 and used.min() < used.max():
            answer = self._fit_trend(matrix[:, 0], values, weights)
        else:
            answer = self._fit_hyperplane(matrix, values, weights)
        if isinstance(answer, NoFit):
            # Data without a model, not data of a wrong type.
            raise ValueError(  # noqa: TRY004
                f"{answer.message} (n_samples = {len(used)})"
            )
        self.trend_ = answer if isinstance(answer, Trend) else None
        if isinstance(answer, Trend):
            self._take_trend(answer)
        else:
            self._take_hyperplane(answer)
        return self

    def predict(self, X: ArrayLike) -> FloatArray:
        """Value of the model.

        Parameters
        ----------
        X : array_like, shape (n_samples, n_features)

        Returns
        -------
        ndarray of float64, shape (n_samples,)
        """
        check_is_fitted(self)
        matrix = validate_data(self, X, dtype=np.float64, order="C", reset=False)
        # From the center of the data, since far from 0 the intercept alone has lost digits.
        return np.asarray(self._level + (matrix - self._center) @ self.coef_)

    def _fit_trend(self, x: FloatArray, y: FloatArray, weights: FloatArray | None) -> Trend | NoFit:
        return fit_trend(
            x,
            y,
            method=self.method,
            threshold=self.threshold,
            sigma=self.sigma,
            weights=weights,
            level=self.level,
            seed=self._seed(),
            options=self.options,
        )

    def _fit_hyperplane(self, X: FloatArray, y: FloatArray, weights: FloatArray | None) -> Hyperplane | NoFit:
        options = RobustOptions() if self.options is None else self.options
        if not isinstance(options, RobustOptions):
            raise InputError("options", "expected a RobustOptions")
        return fit_hyperplane(
            X,
            y,
            weights,
            preset=look_up("method", self.method, PRESETS),
            threshold=check_positive("threshold", self.threshold),
            sigma=check_positive("sigma", self.sigma),
            level=check_fraction("level", self.level),
            seed=self._seed(),
            options=options,
        )

    def _seed(self) -> int:
        """Take an integer as the seed itself; else draw one, as is the custom in scikit-learn."""
        if self.random_state is None or isinstance(self.random_state, np.random.RandomState):
            return int(check_random_state(self.random_state).randint(2**31))
        return check_seed(self.random_state)

    def _take_trend(self, trend: Trend) -> None:
        slope = trend.parameters["slope"]
        numbers = [np.nan if number is None else number for number in (slope.stderr, slope.low, slope.high)]
        self.coef_ = np.array([slope.value])
        self.intercept_ = trend.parameters["intercept"].value
        self.stderr_ = np.array(numbers[:1])
        self.interval_ = np.array([numbers[1:]])
        self.inlier_mask_ = trend.points.inlier
        self.inlier_probability_ = trend.points.probability
        self.sigma_ = trend.consensus.sigma
        self.threshold_ = trend.consensus.threshold
        first = float(trend.time.min())
        self._center = np.array([first])
        self._level = float(trend.predict([first]).value[0])

    def _take_hyperplane(self, plane: Hyperplane) -> None:
        self.coef_ = plane.coefficients
        self.intercept_ = plane.level - float(np.sum(plane.coefficients * plane.center))
        self.stderr_ = plane.stderr
        self.interval_ = np.column_stack([plane.low, plane.high])
        self.inlier_mask_ = plane.inlier
        self.inlier_probability_ = plane.probability
        self.sigma_ = plane.sigma
        self.threshold_ = plane.threshold
        self._center = plane.center
        self._level = plane.level


__all__ = ["PlumblineRegressor"]
