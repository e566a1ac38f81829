r"""The posterior over sets of faulty satellites, of one epoch.

Each set F of k satellites is a hypothesis: their ranges carry biases b_i ~ N(0, (s B)^2), the rest noise of
s sigma_i, position and clocks are anything. The integrals over position, clocks and biases are Gaussian, so
that the marginal likelihood is a closed form in the parity space of the solution that uses all satellites
(METHODS_GNSS, "A decision that is honest and still answers"):

    ln w_F = ln pi_k + ln mean_B exp{ - 1/2 ln|S_FF + D_B| - sum_F ln(B / sigma_i)
                                      - (a + m/2) ln(1 + (z'z - z_F'(S_FF + D_B)^-1 z_F) / (2 b)) },

D_B = diag(sigma_i^2 / B^2), m = n - p, pi_k the prior probability of a set of k satellites
(:func:`estimators.gnss.snapshot.fault_weight.next_odds`). Where METHODS fixes the scale s of the noise
beforehand, here s^2 has an inverse-gamma prior (a, b) and is integrated out, which turns the exponential into
the power of a Student density: sigmas that are stated too large or too small change the confidence of an
answer, and hardly the answer.

Small sets are enumerated (:mod:`estimators.gnss.snapshot.enumeration`); where there are too many, larger ones
are found by a beam of the best (:mod:`estimators.gnss.snapshot.beam`), and by consensus
(:mod:`estimators.gnss.snapshot.consensus_sets`).
"""

from __future__ import annotations

import math

import numpy as np

from estimators.arrays import FloatArray, IntArray
from estimators.gnss.snapshot.beam import BEAM, search_beam
from estimators.gnss.snapshot.consensus_sets import MOST_PROPOSED, propose_sets
from estimators.gnss.snapshot.enumeration import enumerate_sets
from estimators.gnss.snapshot.fault_weight import LARGEST_SET, fill_priors
from estimators.kernels import device

MOST_ENUMERATED = 1900
"""Sets; eleven satellites with one clock have 1816 that can be judged."""
CAPACITY = MOST_ENUMERATED + LARGEST_SET * BEAM + MOST_PROPOSED + 1


@device
def enumerated_size(n: int, most: int) -> int:
    """Largest size up to which all sets are enumerated."""
    total = 1.0
    binomial = 1.0
    size = 0
    while size < most:
        binomial *= (n - size) / (size + 1.0)
        total += binomial
        if total > MOST_ENUMERATED:
            break
        size += 1
    return size


@device
def is_exhaustive(n: int, freedom: int) -> bool:
    """Whether every set that the data can judge is enumerated."""
    return freedom <= LARGEST_SET and enumerated_size(n, freedom) == freedom


@device
def weigh_fault_sets(
    A: FloatArray,
    S: FloatArray,
    z: FloatArray,
    sigma: FloatArray,
    clock: IntArray,
    order: IntArray,
    freedom: int,
    limit: float,
    fault_prior: float,
    shape: float,
    scale: float,
    members: IntArray,
    sizes: IntArray,
    weights: FloatArray,
) -> int:
    """Fill fault sets and their ln weights, the empty set first; returns how many.

    Parameters
    ----------
    A, S, z, sigma : ndarray
        Whitened design, parity matrix and whitened residuals of the solution by all satellites; noise in
        metres.
    clock : ndarray of int64, shape (n,)
        Receiver clock of each satellite.
    order : ndarray of int64, shape (n,)
        Satellites in an order that does not hang on how they were given.
    freedom : int
        n - p.
    limit : float
        Sum of squares below which an epoch that looks healthy is not searched by consensus.
    fault_prior, shape, scale : float
        Prior probability of a fault; inverse-gamma prior of the squared noise scale.
    members : ndarray of int64, shape (CAPACITY, LARGEST_SET)
        Out; satellites of each set, in increasing order.
    sizes : ndarray of int64, shape (CAPACITY,)
        Out.
    weights : ndarray of float64, shape (CAPACITY,)
        Out; ln w up to a constant.
    """
    n = z.size
    halves = int(2.0 * shape + 0.5) + freedom
    squares = 0.0
    for i in range(n):
        squares += z[i] * z[i]
    most = min(freedom, LARGEST_SET)
    priors = np.empty(most + 1)
    fill_priors(n, fault_prior, priors)
    weights[0] = priors[0] - 0.5 * halves * math.log1p(0.5 * squares / scale)
    sizes[0] = 0
    enumerated = enumerated_size(n, most)
    found = enumerate_sets(S, z, sigma, squares, halves, scale, priors, enumerated, members, sizes, weights)
    if 0 < enumerated < most:
        found = search_beam(
            S, z, sigma, squares, freedom, halves, scale, priors, enumerated, members, sizes, weights, found
        )
        if squares >= limit or weights[:found].max() > weights[0]:
            found = propose_sets(
                A, S, z, sigma, clock, order, squares, halves, scale, priors, enumerated,
                members, sizes, weights, found,
            )  # fmt: skip
    return found
