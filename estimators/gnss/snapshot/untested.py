r"""What no range can testify against: sets of more faulty satellites than there are redundant ones.

A set of more than m = n - p satellites leaves fewer ranges than unknowns. Nothing contradicts it, whatever
the data, and the position under it may be anywhere; such sets need not be enumerated, but their probability
belongs to the answer. If biases are so large that their density is flat over the solutions left, the
marginal likelihood of a set G of m + 1 satellites is an integral along a line, which its subsets F of m
satellites, of zero redundancy, sample where one of the biases vanishes. By the inequality of Cauchy and
Schwarz on the slopes of the biases along the line

    w_G <= pi_(m+1) / pi_m (m + 1)^(-3/2) sum_F w_F.

Biases are not that large: this came to between 0.3 and 2.4 of the exact sum on simulated skies of five to
nine satellites. With 1 / (m + 1) instead, which is exact for m = 0, it is the sum or somewhat more. Each F
lies in n - m such sets, and every further satellite costs its prior odds alone.
"""

from __future__ import annotations

import math

from estimators.arrays import FloatArray, IntArray
from estimators.gnss.snapshot.fault_weight import next_odds
from estimators.kernels import device


@device
def untested_weight(
    n: int, freedom: int, fault_prior: float, sizes: IntArray, weights: FloatArray, found: int, largest: float
) -> float:
    """Sum of the weights of all sets that nothing can judge, in units of exp(largest).

    Parameters
    ----------
    n, freedom : int
    fault_prior : float
    sizes : ndarray of int64
    weights : ndarray
        Of the sets found, ln w up to a constant.
    found : int
    largest : float
    """
    weight = 0.0
    for place in range(found):
        if sizes[place] == freedom:
            weight += math.exp(weights[place] - largest)
    total = 0.0
    for size in range(freedom, n):
        weight *= next_odds(n, size, fault_prior) * (n - size) / (size + 1.0)
        total += weight
    return total
