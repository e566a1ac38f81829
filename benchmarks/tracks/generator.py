"""From a scenario and a seed to a recording: the same bytes whenever it is asked."""

from __future__ import annotations

import zlib
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np

from benchmarks.tracks.disorder import Repeated, Unsorted, WrongClock
from benchmarks.tracks.faults import Draft, Fault
from benchmarks.tracks.motions import Motion, at_times
from benchmarks.tracks.noises import NoiseLaw
from benchmarks.tracks.recording import FAULTY, GOOD, UNSCORED, Recording, from_plane
from benchmarks.tracks.samplings import Sampling

START_S = 1.7e9
TOWN = (48.137, 11.575)
_HIDDEN, _TAIL = 3.0, 5.0
"""Sigmas under which an injected offset cannot be told from noise, and beyond which noise looks like one."""

Split: TypeAlias = Literal["tune", "held_out"]
Group: TypeAlias = Literal["clean", "spikes", "bursts", "mixed", "hard", "coloured", "sparse", "other"]


@dataclass(frozen=True, slots=True)
class Scenario:
    """A type of track.

    Attributes
    ----------
    name : str
    group : str
        Of the tables.
    split : {"tune", "held_out"}
        Whether methods may be tuned on it.
    motion : callable
        See :mod:`benchmarks.tracks.motions`.
    noise : callable
        See :mod:`benchmarks.tracks.noises`.
    faults : tuple of Fault
    sampling : callable
        See :mod:`benchmarks.tracks.samplings`.
    duration_s : float
    clock : WrongClock or None
    disorder : tuple
        What happens to the rows afterwards.
    quantum_deg : float
        Step to which degrees are rounded; 0: not.
    place : tuple of float
        Latitude and longitude of the start, degrees.
    zeroed : bool
        Whether the faulty rows read latitude 0, longitude 0.
    """

    name: str
    group: Group
    split: Split
    motion: Motion
    noise: NoiseLaw
    sampling: Sampling
    faults: tuple[Fault, ...] = ()
    duration_s: float = 900.0
    clock: WrongClock | None = None
    disorder: tuple[Repeated | Unsorted, ...] = ()
    quantum_deg: float = 0.0
    place: tuple[float, float] = TOWN
    zeroed: bool = False

    @property
    def share(self) -> float:
        """Share of the rows with an injected fault."""
        return sum(fault.share for fault in self.faults) + (self.clock.share if self.clock else 0.0)


def record(scenario: Scenario, seed: int) -> Recording:
    """Draw a track.

    Parameters
    ----------
    scenario : Scenario
    seed : int

    Examples
    --------
    >>> from benchmarks.tracks.scenarios import SCENARIOS
    >>> recording = record(SCENARIOS["city, spikes 20 %"], seed=1)
    >>> len(recording), int(recording.faulty.sum())
    (900, 180)
    """
    rng = np.random.default_rng((seed, zlib.crc32(scenario.name.encode())))
    path = scenario.motion(scenario.duration_s, rng)
    taken = scenario.sampling(scenario.duration_s, rng)
    n = taken.size
    stated = taken if scenario.clock is None else scenario.clock.stamps(taken, rng)
    there = at_times(path, taken)
    truth = at_times(path, stated)
    noise = scenario.noise(taken, rng)
    offset = there - truth
    draft = Draft(taken, there + noise.error_m, stated != taken)
    for fault in scenario.faults:
        rows, off = fault.strike(draft, rng)
        draft.fixes[rows] += off
        offset[rows] += off
        draft.faulty[rows] = True
    lat, lon = from_plane(draft.fixes, scenario.place)
    quantum_m = 0.0
    if scenario.quantum_deg > 0.0:
        lat, lon = (np.round(x / scenario.quantum_deg) * scenario.quantum_deg for x in (lat, lon))
        quantum_m = scenario.quantum_deg * 111_195.0
    sigma = np.sqrt(noise.sigma_m**2 + quantum_m**2 / 12.0)
    size = np.hypot(offset[:, 0], offset[:, 1])
    if scenario.zeroed:
        lat[draft.faulty] = lon[draft.faulty] = 0.0
        size[draft.faulty] = np.inf
    label = np.full(n, GOOD, dtype=np.int8)
    label[draft.faulty] = np.where(size[draft.faulty] > _HIDDEN * sigma[draft.faulty], FAULTY, UNSCORED)
    tail = np.hypot(noise.error_m[:, 0], noise.error_m[:, 1]) > _TAIL * noise.sigma_m
    label[tail & ~draft.faulty] = UNSCORED
    true_lat, true_lon = from_plane(truth, scenario.place)
    recording = Recording(
        scenario.name, START_S + stated, lat, lon, noise.accuracy_m, true_lat, true_lon, label, draft.faulty,
        sigma,
    )  # fmt: skip
    for disorder in scenario.disorder:
        recording = disorder.mix(recording, rng)
    return recording
