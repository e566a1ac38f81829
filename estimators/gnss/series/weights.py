"""How much a residual counts in a series: by the probability of a fault, or one-sidedly among buildings.

Open sky: the posterior probability that the range is healthy, under the same faults as the snapshot posterior
(:mod:`estimators.gnss.snapshot.fault_sets`). City: reflections only lengthen ranges, and most satellites
suffer some, so that a positive residual loses weight at once (Cauchy, 0.5) and a negative one late
(Huber, 2.5) (METHODS_GNSS, "Cities").
"""

from __future__ import annotations

import math

import numpy as np

from estimators.arrays import FloatArray
from estimators.gnss.snapshot.fault_weight import BIASES_M
from estimators.kernels import device

OPEN, CITY = 0, 1
"""Codes of the surroundings in compiled code."""
_CAUCHY = 0.5
_HUBER = 2.5
_ROOT = math.sqrt(2.0 * math.pi)


@device
def log_density(residual_m: float, sigma_m: float, scale: float, fault_prior: float) -> float:
    """Log density of a range residual in metres: healthy, or faulty with a bias of unknown size."""
    healthy, faulty = _parts(residual_m, sigma_m, scale, fault_prior)
    return math.log(max(healthy + faulty, 1e-300))


@device
def healthy_probability(residual_m: float, sigma_m: float, scale: float, fault_prior: float) -> float:
    """Posterior probability that a range with this residual is healthy."""
    healthy, faulty = _parts(residual_m, sigma_m, scale, fault_prior)
    return healthy / max(healthy + faulty, 1e-300)


@device
def _parts(residual_m: float, sigma_m: float, scale: float, fault_prior: float) -> tuple[float, float]:
    noise = scale * sigma_m
    u = residual_m / noise
    healthy = (1.0 - fault_prior) * math.exp(-0.5 * u * u) / (_ROOT * noise)
    faulty = 0.0
    for b in range(BIASES_M.size):
        wide = math.sqrt(noise * noise + BIASES_M[b] * BIASES_M[b])
        v = residual_m / wide
        faulty += math.exp(-0.5 * v * v) / (_ROOT * wide)
    return healthy, fault_prior * faulty / BIASES_M.size


@device
def one_sided(u: float) -> float:
    """Weight of a whitened residual among buildings."""
    if u > 0.0:
        return 1.0 / (1.0 + (u / _CAUCHY) ** 2)
    return 1.0 if u > -_HUBER else -_HUBER / u


@device
def cauchy(u: float) -> float:
    """Weight of a whitened residual that may be gross on either side."""
    return 1.0 / (1.0 + (u / _HUBER) ** 2)


def fault_probabilities(
    residual_m: FloatArray, sigma_m: FloatArray, scale: float, fault_prior: float
) -> FloatArray:
    """Posterior probability of each range to be faulty; the complement of :func:`healthy_probability`.

    Parameters
    ----------
    residual_m, sigma_m : ndarray, shape (rows,)
    scale, fault_prior : float
    """
    noise = scale * sigma_m
    healthy = (1.0 - fault_prior) * np.exp(-0.5 * (residual_m / noise) ** 2) / noise
    wide = np.sqrt(noise[:, None] ** 2 + BIASES_M**2)
    faulty = fault_prior * (np.exp(-0.5 * (residual_m[:, None] / wide) ** 2) / wide).mean(axis=1)
    return np.asarray(faulty / np.maximum(healthy + faulty, 1e-300))
