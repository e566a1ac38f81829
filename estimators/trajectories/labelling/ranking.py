"""Branches in order of their scores, as many as are asked for: a heap with the likeliest on top.

Of branches that score the same the earlier comes first, so that the order does not depend on the heap.
"""

from __future__ import annotations

from estimators.arrays import FloatArray, IntArray
from estimators.kernels import arithmetic


@arithmetic
def pile(scores: FloatArray, heap: IntArray, count: int) -> None:
    """Make a heap of the first ``count`` branches."""
    for place in range(count):
        heap[place] = place
    for place in range(count // 2 - 1, -1, -1):
        _sink(scores, heap, place, count)


@arithmetic
def take_top(scores: FloatArray, heap: IntArray, count: int) -> int:
    """Take the likeliest out of a heap of ``count`` branches, which has one less then."""
    top = heap[0]
    heap[0] = heap[count - 1]
    _sink(scores, heap, 0, count - 1)
    return int(top)


@arithmetic
def _sink(scores: FloatArray, heap: IntArray, place: int, count: int) -> None:
    held = heap[place]
    while True:
        child = 2 * place + 1
        if child >= count:
            break
        if child + 1 < count and _is_before(scores, heap[child + 1], heap[child]):
            child += 1
        if not _is_before(scores, heap[child], held):
            break
        heap[place] = heap[child]
        place = child
    heap[place] = held


@arithmetic
def _is_before(scores: FloatArray, one: int, other: int) -> bool:
    return bool(scores[one] > scores[other] or (scores[one] == scores[other] and one < other))
