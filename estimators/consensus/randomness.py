"""Counter-based randomness: every random number is a hash of (seed, stream, index, draw).

Hypothesis 17 gets the same sample whether it is drawn first or last, alone or in a block, on one thread or
on eight (METHODS.md 13.8). The hash is the finaliser of SplitMix64 applied along the counters; bits become
indices by multiplication and shift, whose bias is below n / 2**64. No library's distributions are involved,
whose streams may change between versions.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
from numba import types

from estimators.arrays import IntArray
from estimators.kernels import device, kernel

SAMPLES = 0
"""Stream of the minimal samples; its index is the hypothesis."""
SUBSETS = 1
"""Stream of the larger samples that local optimisation draws; its index is the hypothesis it started from."""
TIES = 2
"""Stream that orders points of equal quality; its index is the point."""

_GOLDEN = np.uint64(0x9E3779B97F4A7C15)
_MULTIPLIER_1 = np.uint64(0xBF58476D1CE4E5B9)
_MULTIPLIER_2 = np.uint64(0x94D049BB133111EB)
_ONE = np.uint64(1)
_LOW = np.uint64(0xFFFFFFFF)
_S27, _S30, _S31, _S32 = np.uint64(27), np.uint64(30), np.uint64(31), np.uint64(32)


def as_counter(seed: int) -> int:
    """Any integer as the 64 bits, read as a signed number, that compiled code takes for a seed."""
    return (seed + 2**63) % 2**64 - 2**63


@device
def mix(z: Any) -> Any:
    """Mix 64 bits one to one: the finaliser of SplitMix64 (Steele, Lea & Flood 2014)."""
    z = (z ^ (z >> _S30)) * _MULTIPLIER_1
    z = (z ^ (z >> _S27)) * _MULTIPLIER_2
    return z ^ (z >> _S31)


@device
def random_key(seed: int, stream: int, index: int) -> Any:
    """Hash one hypothesis (or point) of one stream to its key."""
    z = mix(np.uint64(seed) + _GOLDEN * (np.uint64(stream) + _ONE))
    return mix(z + _GOLDEN * (np.uint64(index) + _ONE))


@device
def random_bits(key: Any, draw: int) -> Any:
    """Hash a key and a draw to 64 random bits."""
    return mix(key + _GOLDEN * (np.uint64(draw) + _ONE))


@device
def index_below(bits: Any, n: int) -> int:
    """Map bits to 0 .. n - 1 as floor(bits * n / 2**64), for n < 2**32."""
    m = np.uint64(n)
    carry = ((bits & _LOW) * m) >> _S32
    return int(np.int64(((bits >> _S32) * m + carry) >> _S32))


@device
def draw_distinct(key: Any, n: int, s: int, sample: IntArray) -> None:
    """Fill ``sample[:s]`` with distinct indices below n, uniformly and ascending.

    The j-th draw is uniform on the n - j indices that are left; stepping over the earlier ones in
    ascending order finds which index that is (METHODS.md 4.1). No draw is ever refused.
    """
    for j in range(s):
        value = index_below(random_bits(key, j), n - j)
        place = 0
        while place < j and value >= sample[place]:
            value += 1
            place += 1
        for k in range(j, place, -1):
            sample[k] = sample[k - 1]
        sample[place] = value


@device
def draw_stratified(key: Any, first: int, n: int, k: int, chosen: IntArray) -> None:
    """Fill ``chosen[:k]`` with one index from each of k equal stretches of 0 .. n - 1, ascending.

    Distinct by construction and spread along the order of the points; the jitter inside a stretch keeps
    the choice from locking on to a period.
    """
    for j in range(k):
        low = j * n // k
        high = (j + 1) * n // k
        chosen[j] = low + index_below(random_bits(key, first + j), high - low)


@kernel(types.uint64[:, ::1](types.int64, types.int64, types.int64, types.int64, types.int64))
def random_block(seed: int, stream: int, first: int, count: int, draws: int) -> npt.NDArray[np.uint64]:
    """Random bits of a whole block of indices.

    Parameters
    ----------
    seed : int
        As :func:`as_counter` returns it.
    stream : int
    first, count : int
        The block is ``first .. first + count - 1``.
    draws : int
        Numbers per index.

    Returns
    -------
    ndarray of uint64, shape (count, draws)

    Examples
    --------
    >>> random_block(0, SAMPLES, 5, 1, 2).tolist() == random_block(0, SAMPLES, 0, 9, 2)[5:6].tolist()
    True
    """
    out = np.empty((count, draws), dtype=np.uint64)
    for k in range(count):
        key = random_key(seed, stream, first + k)
        for j in range(draws):
            out[k, j] = random_bits(key, j)
    return out


@kernel(types.int64[::1](types.int64, types.int64, types.int64, types.int64, types.int64))
def stratified_subset(seed: int, index: int, first: int, n: int, k: int) -> IntArray:
    """Positions of a stratified subset, as :func:`draw_stratified` draws it for local optimisation."""
    chosen = np.empty(k, dtype=np.int64)
    draw_stratified(random_key(seed, SUBSETS, index), first, n, k, chosen)
    return chosen
