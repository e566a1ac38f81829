"""Which fixes lie, and by how much: exactly the share asked for, in spikes or in runs."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from benchmarks.tracks.offsets import Offset
from estimators.arrays import BoolArray, FloatArray, IntArray


@dataclass(frozen=True, slots=True)
class Draft:
    """A track while it is made.

    Attributes
    ----------
    t_s : ndarray, shape (n,)
        Ascending.
    fixes : ndarray, shape (n, 2)
        Truth, noise and the faults so far.
    faulty : ndarray of bool, shape (n,)
        Rows with a fault already.
    """

    t_s: FloatArray
    fixes: FloatArray
    faulty: BoolArray


@dataclass(frozen=True, slots=True)
class Spikes:
    """Single fixes at random, of this share of all."""

    share: float
    offset: Offset

    def strike(self, draft: Draft, rng: np.random.Generator) -> tuple[IntArray, FloatArray]:
        """Rows and their offsets."""
        free = np.flatnonzero(~draft.faulty)
        rows = np.sort(rng.choice(free, size=round(self.share * draft.t_s.size), replace=False))
        return rows, self.offset(draft.t_s[rows] - draft.t_s[0], rng)


@dataclass(frozen=True, slots=True)
class Bursts:
    """Runs of fixes that are off together, of this share of all."""

    share: float
    offset: Offset
    shortest_s: float
    longest_s: float

    def strike(self, draft: Draft, rng: np.random.Generator) -> tuple[IntArray, FloatArray]:
        """Rows and their offsets."""
        step = float(np.median(np.diff(draft.t_s)))
        runs = _runs(draft.t_s.size, self.share, self.shortest_s / step, self.longest_s / step, rng)
        offsets = [self.offset(draft.t_s[rows] - draft.t_s[rows[0]], rng) for rows in runs]
        return np.concatenate(runs), np.vstack(offsets)


@dataclass(frozen=True, slots=True)
class Stuck:
    """Runs in which the receiver repeats its last position, of this share of all."""

    share: float
    shortest_s: float
    longest_s: float

    def strike(self, draft: Draft, rng: np.random.Generator) -> tuple[IntArray, FloatArray]:
        """Rows and their offsets."""
        step = float(np.median(np.diff(draft.t_s)))
        runs = _runs(draft.t_s.size, self.share, self.shortest_s / step, self.longest_s / step, rng)
        offsets = [draft.fixes[max(0, rows[0] - 1)] - draft.fixes[rows] for rows in runs]
        return np.concatenate(runs), np.vstack(offsets)


@dataclass(frozen=True, slots=True)
class FromTheStart:
    """The first fixes, of this share of all: a receiver that has just been switched on."""

    share: float
    offset: Offset

    def strike(self, draft: Draft, rng: np.random.Generator) -> tuple[IntArray, FloatArray]:
        """Rows and their offsets."""
        rows = np.arange(round(self.share * draft.t_s.size))
        return rows, self.offset(draft.t_s[rows] - draft.t_s[0], rng)


@dataclass(frozen=True, slots=True)
class ToTheEnd:
    """The last fixes, of this share of all: what begins and does not end."""

    share: float
    offset: Offset

    def strike(self, draft: Draft, rng: np.random.Generator) -> tuple[IntArray, FloatArray]:
        """Rows and their offsets."""
        n = draft.t_s.size
        rows = np.arange(n - round(self.share * n), n)
        return rows, self.offset(draft.t_s[rows] - draft.t_s[rows[0]], rng)


Fault = Spikes | Bursts | Stuck | FromTheStart | ToTheEnd


def _runs(n: int, share: float, shortest: float, longest: float, rng: np.random.Generator) -> list[IntArray]:
    """Cut ``share * n`` rows into runs of random length, and spread these with gaps of random length."""
    left, lengths = round(share * n), []
    while left > 0:
        length = min(left, max(1, round(rng.uniform(shortest, longest))))
        lengths.append(length)
        left -= length
    # One row at least stays healthy between runs, so that two of them do not become one.
    spare = n - sum(lengths) - max(0, len(lengths) - 1)
    weights = rng.dirichlet(np.ones(len(lengths) + 1))
    before = np.floor(np.cumsum(weights)[:-1] * spare).astype(np.int64)
    starts = before + np.concatenate([[0], np.cumsum(lengths)[:-1]]) + np.arange(len(lengths))
    return [np.arange(s, s + length) for s, length in zip(starts, lengths, strict=True)]
