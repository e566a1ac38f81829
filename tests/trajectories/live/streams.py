"""Rows of a live track, sent in pieces."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from itertools import pairwise

import numpy as np

from estimators import LiveRows, LiveTrack, clean_live
from estimators.arrays import FloatArray
from estimators.trajectories.live.answer import joined
from tests.trajectories.drives import MUNICH, Drive


@dataclass(frozen=True)
class Columns:
    """What a receiver sends."""

    t: FloatArray
    lat: FloatArray
    lon: FloatArray
    accuracy: FloatArray | None = None
    height: FloatArray | None = None

    def send(self, first: int, last: int, state: str | None = None, **settings: object) -> LiveTrack:
        part = slice(first, last)
        return clean_live(
            self.t[part],
            self.lat[part],
            self.lon[part],
            accuracy_m=None if self.accuracy is None else self.accuracy[part],
            height_m=None if self.height is None else self.height[part],
            state=state,
            **settings,  # type: ignore[arg-type]
        )

    def send_in(self, cuts: Sequence[int]) -> tuple[LiveRows, str]:
        """All settled rows, the last ones by finishing, and the last state."""
        parts, state = [], None
        for first, last in pairwise([0, *sorted(cuts), self.t.size]):
            answer = self.send(first, last, state)
            parts.append(answer.settled)
            state = answer.state
        answer = self.send(self.t.size, self.t.size, state, finish=True)
        return joined([*parts, answer.settled]), answer.state


def columns(drive: Drive) -> Columns:
    return Columns(drive.t, *MUNICH.locate(drive.fixes))


def bytes_of(rows: LiveRows) -> list[bytes]:
    return [getattr(rows, item.name).tobytes() for item in fields(LiveRows)]


def disordered(made: Drive, seed: int) -> Columns:
    """Rows swapped, repeated, late, without a time and without a place."""
    rng = np.random.default_rng(seed)
    rows = np.arange(made.t.size)
    for k in range(20, rows.size - 10, 23):
        rows[[k, k + 5]] = rows[[k + 5, k]]
    rows = np.sort(np.concatenate([rows, [50, 51, 90]]) + 0) if seed % 2 else rows
    sent = columns(made)
    t, lat, lon = sent.t[rows].copy(), sent.lat[rows].copy(), sent.lon[rows].copy()
    t[rng.integers(0, rows.size, 3)] = np.nan
    lat[rng.integers(0, rows.size, 3)] = 91.0
    t[rng.integers(60, rows.size)] -= 55.0
    accuracy = np.where(rng.random(rows.size) < 0.1, np.nan, rng.uniform(3.0, 9.0, rows.size))
    return Columns(t, lat, lon, accuracy, rng.normal(500.0, 3.0, rows.size))
