r"""Fault sets by consensus: where all sets are too many, minimal samples of satellites propose large ones.

A beam grows sets one satellite at a time, so it never meets a large set whose parts look worse than the empty
set: five satellites whose signals took the same way round agree with one another, and leaving out one or two
of them explains nothing. Sampling finds them as RANSAC does (Fischler and Bolles 1981): a minimal sample of
satellites gives a position, a fit to those nearest to it the next (concentration steps; Rousseeuw and Van
Driessen 1999), and the satellites farthest off, taken one after the other, are a chain of nested fault sets.
What a set is worth is still its exact posterior weight; the samples only say where to look. Satellites added
to a good set, and taken from it, follow, so that doubt about one of them is seen.

Samples are drawn in the order of the ranges, from a fixed sequence: the answer knows no order of satellites.
"""

from __future__ import annotations

import numpy as np

from estimators.arrays import BoolArray, FloatArray, IntArray
from estimators.gnss.snapshot.fault_weight import BIASES_M, LARGEST_SET, extend, fill_width, log_weight
from estimators.gnss.snapshot.linearise import factorise, fill_normal, solve_factorised
from estimators.kernels import device

SAMPLES = 64
"""Seven of 24 healthy ones among 32 are drawn with a probability of .1: all of 64 samples miss with .001."""
MOST_PROPOSED = 512
HOPELESS = 12.0
"""Sets exp(-12) times as likely as the best are passed over."""
_PARENTS = 8
_ROUNDS = 2
_CONCENTRATIONS = 3
_MULTIPLIER, _MODULUS = 48271, 2147483647
"""Park and Miller's generator: its products fit 64 bits."""


@device
def next_random(state: int) -> int:
    """State of the generator after this one."""
    return state * _MULTIPLIER % _MODULUS


@device
def draw_sample(state: int, order: IntArray, clock: IntArray, p: int, used: BoolArray) -> int:
    """Mark a satellite of every system and three more; returns the generator's state."""
    n = order.size
    used[:] = False
    for system in range(p - 3):
        count = 0
        for i in range(n):
            count += clock[i] == system
        state = next_random(state)
        wanted = state % count
        for place in range(n):
            i = order[place]
            if clock[i] == system:
                if wanted == 0:
                    used[i] = True
                wanted -= 1
    for drawn in range(3):
        state = next_random(state)
        wanted = state % (n - (p - 3) - drawn)
        for place in range(n):
            i = order[place]
            if not used[i]:
                if wanted == 0:
                    used[i] = True
                    break
                wanted -= 1
    return state


@device
def concentrate(
    A: FloatArray, z: FloatArray, used: BoolArray, kept: int, normal: FloatArray, step: FloatArray,
    residual: FloatArray,
) -> bool:  # fmt: skip
    """Squared residuals about the fit to a sample, and then about that to the ``kept`` nearest satellites."""
    n, p = A.shape
    for turn in range(_CONCENTRATIONS):
        fill_normal(A, z, used, normal, step)
        if not factorise(normal):
            return turn > 0
        solve_factorised(normal, step)
        for i in range(n):
            held = z[i]
            for j in range(p):
                held -= A[i, j] * step[j]
            residual[i] = held * held
        nearest = np.argsort(residual, kind="mergesort")
        used[:] = False
        for place in range(kept):
            used[nearest[place]] = True
    return True


@device
def propose_sets(
    A: FloatArray,
    S: FloatArray,
    z: FloatArray,
    sigma: FloatArray,
    clock: IntArray,
    order: IntArray,
    squares: float,
    halves: int,
    scale: float,
    priors: FloatArray,
    enumerated: int,
    members: IntArray,
    sizes: IntArray,
    weights: FloatArray,
    found: int,
) -> int:
    """Append the sets that samples lead to, where they are likely and not there yet; returns how many are.

    Parameters
    ----------
    A, S, z, sigma : ndarray
        Whitened design, parity matrix and whitened residuals of the solution by all satellites; noise in
        metres.
    clock : ndarray of int64, shape (n,)
    order : ndarray of int64, shape (n,)
        Satellites in an order that does not hang on how they were given.
    squares, halves, scale, priors
        As in :func:`estimators.gnss.snapshot.beam.search_beam`.
    enumerated : int
        Largest size of which all sets are there.
    members, sizes, weights : ndarray
        Sets so far; extended.
    found : int
    """
    n, p = A.shape
    most = priors.size - 1
    count = BIASES_M.size
    ridge = np.zeros((count + 1, n))
    for b in range(count):
        for i in range(n):
            ridge[b + 1, i] = (sigma[i] / BIASES_M[b]) ** 2
    factor = np.empty((count + 1, LARGEST_SET, LARGEST_SET))
    solved = np.empty((count + 1, LARGEST_SET))
    explained = np.empty((count + 1, LARGEST_SET))
    determinant = np.empty((count + 1, LARGEST_SET))
    width = np.empty(count)
    normal, step, residual = np.empty((p, p)), np.empty(p), np.empty(n)
    used = np.empty(n, np.bool_)
    chains = np.empty((SAMPLES, most), np.int64)
    row_of = np.empty(LARGEST_SET, np.int64)
    kept = max((n + p + 1) // 2, n - LARGEST_SET)
    capacity = min(weights.size, found + MOST_PROPOSED)
    first = found
    best = weights[:found].max()
    state, known = 1, 0
    for _ in range(SAMPLES):
        state = draw_sample(state, order, clock, p, used)
        if not concentrate(A, z, used, kept, normal, step, residual):
            continue
        farthest = np.argsort(-residual, kind="mergesort")
        seen = False
        for chain in range(known):
            same = True
            for row in range(most):
                same = same and chains[chain, row] == farthest[row]
            seen = seen or same
        if seen:
            continue
        chains[known] = farthest[:most]
        known += 1
        for depth in range(most):
            if not extend(S, z, ridge, farthest, depth, farthest[depth],
                          factor, solved, explained, determinant):  # fmt: skip
                break
            if depth < enumerated:
                continue
            fill_width(sigma, farthest, depth + 1, determinant[:, depth], width)
            weight = log_weight(priors[depth + 1], halves, squares, scale, explained[:, depth], width)
            if weight > best - HOPELESS and found < capacity:
                row_of[: depth + 1] = np.sort(farthest[: depth + 1])
                found = append_new(members, sizes, weights, found, depth + 1, row_of, weight)
                best = max(best, weight)

    chosen = np.empty(LARGEST_SET, np.int64)
    start = first
    for _ in range(_ROUNDS):
        end = found
        heaviest = start + np.argsort(-weights[start:end], kind="mergesort")
        for parent in heaviest[:_PARENTS]:
            size = sizes[parent]
            # Satellite i is added to the set; where it is a member, it is taken from it.
            for i in range(n):
                new = 0
                for row in range(size):
                    if members[parent, row] != i:
                        chosen[new] = members[parent, row]
                        new += 1
                if new == size:
                    if size == most:
                        continue
                    chosen[new] = i
                    new += 1
                if new <= enumerated:
                    continue
                possible = True
                for row in range(new):
                    possible = possible and extend(
                        S, z, ridge, chosen, row, chosen[row], factor, solved, explained, determinant
                    )
                if not possible:
                    continue
                fill_width(sigma, chosen, new, determinant[:, new - 1], width)
                weight = log_weight(priors[new], halves, squares, scale, explained[:, new - 1], width)
                if weight > best - HOPELESS and found < capacity:
                    row_of[:new] = np.sort(chosen[:new])
                    found = append_new(members, sizes, weights, found, new, row_of, weight)
                    best = max(best, weight)
        start = end
    return found


@device
def append_new(
    members: IntArray, sizes: IntArray, weights: FloatArray, found: int, size: int, chosen: IntArray,
    weight: float,
) -> int:  # fmt: skip
    """Append a set, its satellites in increasing order, unless it is there; returns how many there are."""
    for place in range(found):
        if sizes[place] == size and abs(weights[place] - weight) < 1e-6:
            same = True
            for row in range(size):
                same = same and members[place, row] == chosen[row]
            if same:
                return found
    for row in range(size):
        members[found, row] = chosen[row]
    sizes[found] = size
    weights[found] = weight
    return found + 1
