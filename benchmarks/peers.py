"""The peers, each called as its documentation calls it; settings that differ from its defaults are named.

A peer that flags nothing gets the usual flags: residuals beyond 2.7 normalised median absolute deviations.
"""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
import statsmodels.api as sm
from scipy.stats import siegelslopes, theilslopes
from skimage.measure import LineModelND, ransac
from sklearn.linear_model import HuberRegressor, RANSACRegressor, TheilSenRegressor

from benchmarks.contenders import KNOWN_THRESHOLD, Answer, Contender, no_line
from estimators.arrays import FloatArray

TRIALS = 2000
"""Most trials of the sampling peers (the default of both is 100)."""
NORMAL_MAD = 1.4826
"""Standard deviation of a normal law over its median absolute deviation."""


def by_residuals(t: FloatArray, y: FloatArray, slope: float, intercept: float) -> Answer:
    """Line with the usual flags."""
    residual = y - intercept - slope * t
    scale = NORMAL_MAD * float(np.median(np.abs(residual - np.median(residual))))
    return Answer(intercept + slope * t[[0, -1]], np.abs(residual) > KNOWN_THRESHOLD * scale)


def _with_interval(answer: Answer, low: float, high: float, p_value: float = float("nan")) -> Answer:
    return Answer(answer.ends, answer.flagged, float(low), float(high), float(p_value))


def _sklearn_ransac(t: FloatArray, y: FloatArray, threshold: float | None) -> Answer:
    model = RANSACRegressor(residual_threshold=threshold, max_trials=TRIALS, random_state=0)
    model.fit(t[:, None], y)
    return Answer(model.predict(t[[0, -1], None]), ~model.inlier_mask_)


def _sklearn_theil_sen(t: FloatArray, y: FloatArray, _threshold: float | None) -> Answer:
    model = TheilSenRegressor(random_state=0).fit(t[:, None], y)
    return by_residuals(t, y, float(model.coef_[0]), float(model.intercept_))


def _sklearn_huber(t: FloatArray, y: FloatArray, _threshold: float | None) -> Answer:
    model = HuberRegressor().fit(t[:, None], y)
    return Answer(model.predict(t[[0, -1], None]), model.outliers_)


def _skimage_ransac(
    t: FloatArray, y: FloatArray, threshold: float | None, stop_probability: float = 1.0
) -> Answer:
    search: Any = ransac  # untyped
    points = np.column_stack((t, y))
    model, inlier = search(
        points, LineModelND, 2, threshold, max_trials=TRIALS, stop_probability=stop_probability, rng=0
    )
    if not model:
        return no_line(t.size)
    return Answer(np.asarray(model.predict_y(t[[0, -1]])), ~inlier)


def _scipy_theil_sen(t: FloatArray, y: FloatArray, _threshold: float | None) -> Answer:
    slope, intercept, low, high = theilslopes(y, t, 0.95)
    return _with_interval(by_residuals(t, y, float(slope), float(intercept)), low, high)


def _scipy_siegel(t: FloatArray, y: FloatArray, _threshold: float | None) -> Answer:
    slope, intercept = siegelslopes(y, t)
    return by_residuals(t, y, float(slope), float(intercept))


def _linear_answer(fitted: Any, t: FloatArray, y: FloatArray) -> Answer:
    """Line, interval and p-value of a statsmodels result."""
    intercept, slope = fitted.params
    low, high = fitted.conf_int(0.05)[1]
    return _with_interval(by_residuals(t, y, slope, intercept), low, high, fitted.pvalues[1])


def _statsmodels_tukey(t: FloatArray, y: FloatArray, _threshold: float | None) -> Answer:
    fitted = sm.RLM(y, sm.add_constant(t), M=sm.robust.norms.TukeyBiweight()).fit()
    return _linear_answer(fitted, t, y)


def _least_squares(t: FloatArray, y: FloatArray, _threshold: float | None) -> Answer:
    return _linear_answer(sm.OLS(y, sm.add_constant(t)).fit(), t, y)


PEERS: tuple[Contender, ...] = (
    Contender("scikit-learn RANSACRegressor", True, _sklearn_ransac),
    Contender("scikit-image ransac", True, _skimage_ransac),
    Contender("scikit-learn RANSACRegressor", False, _sklearn_ransac),
    Contender("scikit-learn TheilSenRegressor", False, _sklearn_theil_sen),
    Contender("scikit-learn HuberRegressor", False, _sklearn_huber),
    Contender("scipy theilslopes", False, _scipy_theil_sen),
    Contender("scipy siegelslopes", False, _scipy_siegel),
    Contender("statsmodels RLM, Tukey", False, _statsmodels_tukey),
    Contender("least squares", False, _least_squares),
)
SKIMAGE_STOP_99 = Contender(
    "scikit-image ransac, stop_probability=0.99", True, partial(_skimage_ransac, stop_probability=0.99)
)
"""Timed beside the default, which asks for certainty and therefore draws more."""

SLOWEST = frozenset({"scikit-learn TheilSenRegressor"})
"""Left out of smoke runs."""
QUADRATIC = SLOWEST | {"scipy theilslopes", "scipy siegelslopes"}
"""Cost grows with the square of the number of points, or nearly so."""
