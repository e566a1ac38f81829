"""The uncertainty of an exponential under additive noise, on the logarithm of its size.

Near the fit the curve is the weighted line of :mod:`estimators.trends.exponential.additive`; divided by its
level, that line's errors are those of ln(size) and of the rate. So an exponential is a line to everything
that infers, and its curve is compared in the values' own units.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from estimators.arrays import FloatArray
from estimators.inference.sandwich import LineUncertainty, line_uncertainty
from estimators.inference.scores import point_scores
from estimators.trends.exponential.additive import AdditiveFit
from estimators.trends.request import Request
from estimators.trends.resampling import Fitted, Inferred, Refit, Scored, infer

_PROBES = np.linspace(-1.0, 1.0, 9)
"""Frame times at which two curves are compared; an exponential between them lies between its neighbours."""
_DESIGN = np.array([np.ones(9), _PROBES]).T


@dataclass(frozen=True, slots=True)
class NativeFit:
    """An exponential with what its uncertainty is made from.

    Attributes
    ----------
    fit : AdditiveFit
    t, residual : ndarray of float64, shape (n,)
        Frame time; value less curve.
    sums : ndarray of float64
        From :func:`estimators.regression.influence.influence_sums`, of the weighted line.
    """

    fit: AdditiveFit
    t: FloatArray
    residual: FloatArray
    sums: FloatArray

    @property
    def theta(self) -> FloatArray:
        """Logarithm of the size at frame time 0, rate in the frame."""
        size = abs(float(self.fit.found.theta[0])) * self.fit.unit
        return np.array([math.log(size) - self.fit.rate * self.fit.anchor, self.fit.rate])

    @property
    def sigma(self) -> float:
        """Noise scale, in units of the values."""
        return self.fit.found.sigma * self.fit.unit

    def spread(self, *, correct: bool) -> LineUncertainty | None:
        """Uncertainty of ``theta`` by formula."""
        found, amplitude = self.fit.found, float(self.fit.found.theta[0])
        line = line_uncertainty(
            self.sums, self.t.size, found.sigma, found.spread, correct_serial_correlation=correct
        )
        if line is None:
            return None
        # By the level twice: squares of tiny levels would underflow.
        return dataclasses.replace(
            line,
            center=self.fit.anchor + line.center,
            level_variance=line.level_variance / amplitude / amplitude,
            slope_variance=line.slope_variance / amplitude / amplitude,
        )

    def curve(self) -> FloatArray:
        """Values at the probes."""
        log_size = self.theta[0] + self.theta[1] * _PROBES
        with np.errstate(over="ignore", under="ignore"):
            return np.asarray(math.copysign(1.0, float(self.fit.found.theta[0])) * np.exp(log_size))


def infer_native(
    request: Request, native: NativeFit, again: Callable[[FloatArray], NativeFit | None]
) -> Inferred[LineUncertainty]:
    """Uncertainty of an exponential by the method asked for, on the logarithm of its size.

    Parameters
    ----------
    request : Request
    native : NativeFit
    again : callable
        Fits other values at the same times; None where they show no exponential.

    Returns
    -------
    Inferred
    """
    correct = request.options.correct_serial_correlation
    spread = native.spread(correct=correct)
    if spread is None or request.uncertainty == "effective-n":
        return Inferred(spread)
    series, found = request.series, native.fit.found
    curve = native.curve()
    weights, line_root = series.weights, np.sqrt(np.asarray(native.fit.data.weights))

    def refit(values: FloatArray) -> Refit[LineUncertainty] | None:
        replicate = again(values)
        own = None if replicate is None else replicate.spread(correct=correct)
        if replicate is None or own is None:
            return None
        return Refit(replicate.theta, own, replicate.curve(), replicate.sigma)

    fitted = Fitted(
        y=series.y,
        residual=native.residual,
        # Of weighted values the noise is permuted, not the level.
        beside=np.full(series.n, 0.0 if weights is None else float(np.median(series.y))),
        root=None if weights is None else np.sqrt(weights),
        fit=Refit(native.theta, spread, curve, native.sigma),
        axes=spread.axes,
        stderr=np.abs(curve) * spread.stderr(_DESIGN),
        has_trend=True,
        independent=lambda: native.spread(correct=False),
        scored=lambda: Scored(
            native.t,
            point_scores(found.residual, line_root, found.sigma, found.loss),
            np.array([np.ones(series.n), native.t]),
            line_root,
        ),
        again=refit,
    )
    return infer(fitted, request.uncertainty, request.level, request.options.resamples, request.seed)
