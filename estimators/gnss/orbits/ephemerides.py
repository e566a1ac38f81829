"""Broadcast ephemerides as columns, and which of them serves a satellite at a time."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from estimators.arrays import BoolArray, FloatArray, IntArray

NONE, UNHEALTHY = -1, -2
"""In place of an ephemeris: none is near enough in time; the satellite says not to use it."""
BANDS = 10

OLDEST_S: Mapping[str, float] = MappingProxyType(
    {"G": 7200.0, "R": 1800.0, "E": 14400.0, "C": 21600.0, "J": 7200.0, "I": 7200.0}
)
"""How far from its reference time an ephemeris serves. GPS and QZSS: half the fit interval of four hours
(IS-GPS-200, 20.3.4.4); GLONASS: the span its equations are meant for, and as much again (GLONASS ICD, A.3.1);
Galileo: four hours (Galileo OS SDD); BeiDou repeats hourly but lists are often sparser."""


@dataclass(frozen=True, slots=True)
class Ephemerides:
    """Ephemerides sorted by satellite, then by reference time.

    Attributes
    ----------
    names : tuple of str
        Satellites, sorted.
    starts : ndarray of int64, shape (satellites + 1,)
        Satellite j has rows ``starts[j]:starts[j + 1]``.
    toe_ns, toc_ns : ndarray of int64, shape (n,)
        Reference times of orbit and clock: nanoseconds of GPS time.
    elements : ndarray of float64, shape (n, COLUMNS)
        Columns of :mod:`estimators.gnss.orbits.kepler`, or of :mod:`estimators.gnss.orbits.glonass`.
    glonass : ndarray of bool, shape (n,)
        Which of the two.
    healthy : ndarray of bool, shape (n,)
    accuracy_m : ndarray of float64, shape (n,)
        Of orbit and clock, as the message states it.
    delays_s : ndarray of float64, shape (n, BANDS)
        By RINEX band: how much later than the clock says a signal leaves; NaN where not broadcast.
    channels : mapping of str to int
        Frequency channel of GLONASS satellites.
    """

    names: tuple[str, ...]
    starts: IntArray
    toe_ns: IntArray
    toc_ns: IntArray
    elements: FloatArray
    glonass: BoolArray
    healthy: BoolArray
    accuracy_m: FloatArray
    delays_s: FloatArray
    channels: Mapping[str, int]

    def choose(self, names: tuple[str, ...], satellite: IntArray, time_ns: IntArray) -> IntArray:
        """Find the ephemeris nearest in time.

        Parameters
        ----------
        names : tuple of str
        satellite : ndarray of int64, shape (rows,)
            Index into ``names``.
        time_ns : ndarray of int64, shape (rows,)
            Nanoseconds of GPS time.

        Returns
        -------
        ndarray of int64, shape (rows,)
            Row of the ephemeris, :data:`NONE` or :data:`UNHEALTHY`.
        """
        out = np.full(satellite.size, NONE, dtype=np.int64)
        known = {name: j for j, name in enumerate(self.names)}
        order = np.argsort(satellite, kind="stable")
        bounds = np.searchsorted(satellite[order], np.arange(len(names) + 1))
        for i, name in enumerate(names):
            j = known.get(name)
            rows = order[bounds[i] : bounds[i + 1]]
            if j is None or rows.size == 0:
                continue
            a, b = int(self.starts[j]), int(self.starts[j + 1])
            toe, time = self.toe_ns[a:b], time_ns[rows]
            after = np.clip(np.searchsorted(toe, time), 0, b - a - 1)
            before = np.maximum(after - 1, 0)
            nearer = np.abs(toe[before] - time) < np.abs(toe[after] - time)
            best = np.where(nearer, before, after)
            near = np.abs(toe[best] - time) <= OLDEST_S[name[0]] * 1e9
            healthy = self.healthy[a + best]
            out[rows] = np.where(near, np.where(healthy, a + best, UNHEALTHY), NONE)
        return out

    @property
    def systems(self) -> str:
        """Letters of the systems that have an ephemeris, sorted."""
        return "".join(sorted({name[0] for name in self.names}))


@dataclass(frozen=True, slots=True)
class Ephemeris:
    """One broadcast ephemeris, before it becomes a row of :class:`Ephemerides`.

    Attributes
    ----------
    name : str
        Satellite.
    toe_ns, toc_ns : int
        Nanoseconds of GPS time.
    elements : tuple of float
        Shorter rows are padded.
    healthy : bool
    accuracy_m : float
    delays_s : mapping of int to float
        By band.
    channel : int or None
        Of GLONASS.
    """

    name: str
    toe_ns: int
    toc_ns: int
    elements: tuple[float, ...]
    healthy: bool
    accuracy_m: float
    delays_s: Mapping[int, float]
    channel: int | None = None


def stack_ephemerides(ephemerides: list[Ephemeris], columns: int) -> Ephemerides:
    """Sort ephemerides into columns; of several with one reference time the last given counts.

    Parameters
    ----------
    ephemerides : list of Ephemeris
    columns : int
        Width of the table of elements.
    """
    latest = {(e.name, e.toe_ns): e for e in ephemerides}
    rows = [latest[key] for key in sorted(latest)]
    names = tuple(sorted({e.name for e in rows}))
    place = {name: j for j, name in enumerate(names)}
    satellite = np.array([place[e.name] for e in rows], dtype=np.int64)
    elements, delays = np.zeros((len(rows), columns)), np.full((len(rows), BANDS), np.nan)
    for i, e in enumerate(rows):
        elements[i, : len(e.elements)] = e.elements
        for band, delay in e.delays_s.items():
            delays[i, band] = delay
    return Ephemerides(
        names=names,
        starts=np.searchsorted(satellite, np.arange(len(names) + 1)).astype(np.int64),
        toe_ns=np.array([e.toe_ns for e in rows], dtype=np.int64),
        toc_ns=np.array([e.toc_ns for e in rows], dtype=np.int64),
        elements=elements,
        glonass=np.array([e.name[0] == "R" for e in rows], dtype=np.bool_),
        healthy=np.array([e.healthy for e in rows], dtype=np.bool_),
        accuracy_m=np.array([e.accuracy_m for e in rows], dtype=np.float64),
        delays_s=delays,
        channels={e.name: e.channel for e in rows if e.channel is not None},
    )
