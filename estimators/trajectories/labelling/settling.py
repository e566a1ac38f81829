"""What a beam is sure of: labels from which all its hypotheses descend, and how good a fix was by them."""

from __future__ import annotations

import math

import numpy as np

from estimators.arrays import CodeArray, FloatArray
from estimators.kernels import arithmetic, device


@arithmetic
def trace(last: int, h: int, base: int, parent: CodeArray, kind_of: CodeArray, labels: CodeArray) -> None:
    """Write the labels that led to a hypothesis; ``base`` is the fix of the first row."""
    for row in range(last, -1, -1):
        labels[base + row] = kind_of[row, h]
        h = parent[row, h]


@device
def settle(last: int, base: int, used: int, parent: CodeArray, kind_of: CodeArray, labels: CodeArray) -> int:
    """Write the labels that all hypotheses share; returns how many are left, whose rows come first then."""
    ancestor = np.arange(used)
    row = last
    while row >= 0:
        same = True
        for h in range(1, used):
            same = same and ancestor[h] == ancestor[0]
        if same:
            break
        for h in range(used):
            ancestor[h] = parent[row, ancestor[h]]
        row -= 1
    if row < 0:
        return last + 1
    trace(row, ancestor[0], base, parent, kind_of, labels)
    for k in range(row + 1, last + 1):
        parent[k - row - 1], kind_of[k - row - 1] = parent[k], kind_of[k]
    return last - row


@arithmetic
def likeliest(used: int, weight: FloatArray) -> tuple[int, float]:
    """Likeliest hypothesis, and the weight of all in units of its own."""
    h = 0
    for other in range(1, used):
        if weight[other] > weight[h]:
            h = other
    mass = 0.0
    for other in range(used):
        mass += math.exp(weight[other] - weight[h])
    return h, mass


@arithmetic
def share_of_good(row: int, used: int, weight: FloatArray, good: FloatArray) -> float:
    """Probability that a fix was good, over the hypotheses of a later one."""
    held, total = 0.0, 0.0
    for h in range(used):
        mass = math.exp(weight[h])
        total += mass
        held += mass * good[h, row]
    return min(1.0, held / total)
