"""What happens to rows after they were measured: repeated, shuffled, stamped by a clock that jumps.

Each disorder knows the share of rows that it makes faulty; only a wrong clock does.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from benchmarks.tracks.faults import Bursts, Draft
from benchmarks.tracks.offsets import constant
from benchmarks.tracks.recording import Recording
from estimators.arrays import FloatArray, IntArray


@dataclass(frozen=True, slots=True)
class Repeated:
    """A share of the rows comes twice; the twin has the label of its first."""

    portion: float

    def mix(self, recording: Recording, rng: np.random.Generator) -> Recording:
        """Rows with twins behind them."""
        n = len(recording)
        extra = rng.choice(n, size=round(self.portion * n), replace=False)
        return _rows(recording, np.sort(np.concatenate([np.arange(n), extra])))


@dataclass(frozen=True, slots=True)
class Unsorted:
    """A share of the rows comes some places later."""

    portion: float
    places: int

    def mix(self, recording: Recording, rng: np.random.Generator) -> Recording:
        """Rows in another order."""
        n = len(recording)
        late = rng.random(n) < self.portion
        rank = np.arange(n) + np.where(late, rng.uniform(1.0, self.places, n), 0.0)
        return _rows(recording, np.argsort(rank, kind="stable"))


@dataclass(frozen=True, slots=True)
class WrongClock:
    """Runs of rows whose stated time is off by some seconds, of this share of all."""

    share: float
    shortest_s: float
    longest_s: float
    least_s: float
    most_s: float

    def stamps(self, t_s: FloatArray, rng: np.random.Generator) -> FloatArray:
        """Stated times of rows taken at ``t_s``."""
        nowhere = Draft(t_s, np.zeros((t_s.size, 2)), np.zeros(t_s.size, dtype=np.bool_))
        runs = Bursts(self.share, constant(self.least_s, self.most_s), self.shortest_s, self.longest_s)
        rows, jumps = runs.strike(nowhere, rng)
        stated = t_s.copy()
        # The length of the offset, with the sign of one of its components.
        stated[rows] += np.round(np.copysign(np.hypot(jumps[:, 0], jumps[:, 1]), jumps[:, 0]))
        return stated


def _rows(recording: Recording, rows: IntArray) -> Recording:
    columns = {
        name: getattr(recording, name)[rows]
        for name in (
            "t_s",
            "lat_deg",
            "lon_deg",
            "true_lat_deg",
            "true_lon_deg",
            "label",
            "faulty",
            "sigma_m",
        )
    }
    accuracy = None if recording.accuracy_m is None else recording.accuracy_m[rows]
    return replace(recording, accuracy_m=accuracy, **columns)
