"""Enumeration: every minimal sample once, where the work budget allows it (METHODS.md 2.2, second level).

Subsets come in colexicographic order, (0, 1), (0, 2), (1, 2), (0, 3), ..., in which the h-th subset is found
from h alone and the next one from its predecessor.
"""

from __future__ import annotations

from estimators.arrays import IntArray
from estimators.kernels import device

ENUMERATION = 3
"""Code of this sampler in compiled code."""


@device
def subsets_within(n: int, s: int, budget: int) -> int:
    """C(n, s) if enumerating costs at most ``budget`` residual evaluations, C(n, s) * n; otherwise 0."""
    total = 1.0
    for i in range(s):
        total = total * (n - i) / (i + 1)
    if total * n > budget:
        return 0
    return int(total + 0.5)


@device
def nth_subset(index: int, s: int, sample: IntArray) -> None:
    """Find the subset of a rank: its largest element c is the last with C(c, s) <= rank, and so on down."""
    rest = index
    for j in range(s, 0, -1):
        element, below = j - 1, 0
        above = 1
        while above <= rest:
            below = above
            element += 1
            above = above * (element + 1) // (element + 1 - j)
        sample[j - 1] = element
        rest -= below


@device
def next_subset(sample: IntArray) -> None:
    """Advance to the subset of the next rank."""
    s = sample.size
    j = 0
    while j + 1 < s and sample[j] + 1 == sample[j + 1]:
        sample[j] = j
        j += 1
    sample[j] += 1
