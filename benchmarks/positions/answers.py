"""What a solver says to an epoch, and how it is judged."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from benchmarks.positions.faults import Faulty
from estimators.arrays import BoolArray, FloatArray
from estimators.geodesy.ellipsoid import to_geodetic
from estimators.geodesy.local_frame import enu_axes

HARMFUL_M = 30.0


@dataclass(frozen=True, slots=True)
class Answer:
    """A position, if there is one.

    Attributes
    ----------
    position_m : ndarray, shape (3,), or None
    used : ndarray of bool, shape (n,)
        Satellites of the position.
    flagged : bool
        Whether the solver says not to rely on it.
    hpl_m : float or None
    """

    position_m: FloatArray | None
    used: BoolArray
    flagged: bool = False
    hpl_m: float | None = None


@dataclass(frozen=True, slots=True)
class Score:
    """Judgement of one cell; percentages of its epochs unless said otherwise.

    Attributes
    ----------
    strict, right : float
        Answered, unflagged and right: no faulty satellite used; or that, or within 30 m horizontally.
    lies : float
        Answered, unflagged, a faulty satellite used and more than 30 m off.
    forced_strict, forced : float
        Right if flags are passed over.
    flagged, none : float
        Flagged; without a position.
    healthy_excluded : float
        Percent of healthy satellites.
    hpl_m : float
        Median of the unflagged.
    hpl_misses : float
        Percent of the unflagged whose error passes the level.
    error_m : float
        Median horizontal error of the unflagged.
    epochs : int
    """

    strict: float
    right: float
    lies: float
    forced_strict: float
    forced: float
    flagged: float
    none: float
    healthy_excluded: float
    hpl_m: float
    hpl_misses: float
    error_m: float
    epochs: int


def horizontal_error(position_m: FloatArray, truth_m: FloatArray) -> float:
    """Horizontal distance from the truth in metres."""
    lat, lon, _ = to_geodetic(truth_m).tolist()
    east, north, _ = (enu_axes(lat, lon) @ (position_m - truth_m)).tolist()
    return float(np.hypot(east, north))


def judge(faulty: Sequence[Faulty], answers: Iterable[Answer]) -> Score:
    """Count a cell.

    Parameters
    ----------
    faulty : sequence of Faulty
    answers : iterable of Answer
        One each.
    """
    counts = dict.fromkeys(("strict", "right", "lies", "forced_strict", "forced", "flagged", "none"), 0)
    healthy = excluded = misses = unflagged = 0
    levels, errors = [], []
    for given, answer in zip(faulty, answers, strict=True):
        if answer.position_m is None:
            counts["none"] += 1
            continue
        error = horizontal_error(answer.position_m, given.sky.truth_m)
        clean = not bool(np.any(answer.used & given.faulty))
        good = clean or error <= HARMFUL_M
        counts["forced_strict"] += clean
        counts["forced"] += good
        healthy += int(np.sum(~given.faulty))
        excluded += int(np.sum(~given.faulty & ~answer.used))
        if answer.flagged:
            counts["flagged"] += 1
            continue
        unflagged += 1
        errors.append(error)
        counts["strict"] += clean
        counts["right"] += good
        counts["lies"] += not good
        if answer.hpl_m is not None:
            levels.append(answer.hpl_m)
            misses += error > answer.hpl_m
    n = max(1, len(faulty))
    return Score(
        **{name: 100.0 * count / n for name, count in counts.items()},
        healthy_excluded=100.0 * excluded / max(1, healthy),
        hpl_m=float(np.median(levels)) if levels else np.nan,
        hpl_misses=100.0 * misses / max(1, len(levels)) if levels else np.nan,
        error_m=float(np.median(errors)) if errors else np.nan,
        epochs=len(faulty),
    )
