"""What a cleaner says of a track, and how it is judged."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from benchmarks.tracks.recording import FAULTY, GOOD, Recording, length_m
from estimators.arrays import BoolArray, FloatArray

_REGION_95 = -2.0 * math.log(0.05)
"""95 % of chi-square with two degrees of freedom."""
_STANDS_M = 1.0


@dataclass(frozen=True, slots=True)
class Answer:
    """A cleaned track, in the order of the recording.

    Attributes
    ----------
    lat_deg, lon_deg : ndarray, shape (n,)
    flagged : ndarray of bool, shape (n,), or None
        Rows said to lie; None if the cleaner says nothing of rows.
    covariance_m2 : ndarray, shape (n, 2, 2), or None
        East and north.
    distance_m : float or None
        None: the length of the line through the positions.
    """

    lat_deg: FloatArray
    lon_deg: FloatArray
    flagged: BoolArray | None = None
    covariance_m2: FloatArray | None = None
    distance_m: float | None = None


@dataclass(frozen=True, slots=True)
class Score:
    """Judgement of one answer.

    Attributes
    ----------
    hits, misses, alarms, good : int
        Faulty rows flagged and not flagged, good rows flagged, good rows; all 0 if nothing was flagged by
        design.
    rmse_m, raw_m, oracle_m : float
        Root mean square horizontal errors; the oracle's is NaN where nobody knows the faults.
    covered, regions : int
        95 % regions that hold the truth, and how many there were.
    distance_error, raw_distance_error : float
        Relative; NaN for tracks that stand.
    drift_m_per_h : float
        Distance that a track that stands is said to travel in an hour; NaN for others.
    seconds : float
        Processor time.
    points : int
    """

    hits: int
    misses: int
    alarms: int
    good: int
    rmse_m: float
    raw_m: float
    oracle_m: float
    covered: int
    regions: int
    distance_error: float
    raw_distance_error: float
    drift_m_per_h: float
    seconds: float
    points: int


def judge(recording: Recording, answer: Answer, oracle_m: float, seconds: float) -> Score:
    """Hold an answer against the truth.

    Parameters
    ----------
    recording : Recording
    answer : Answer
    oracle_m : float
        See :func:`benchmarks.tracks.oracle.smooth_knowing`.
    seconds : float
        Processor time of the answer.
    """
    error = recording.error_m(answer.lat_deg, answer.lon_deg)
    hits = misses = alarms = good = 0
    if answer.flagged is not None:
        faulty, sound = recording.label == FAULTY, recording.label == GOOD
        hits, alarms = int(np.sum(answer.flagged & faulty)), int(np.sum(answer.flagged & sound))
        misses, good = int(np.sum(faulty)) - hits, int(np.sum(sound))
    covered = regions = 0
    if answer.covariance_m2 is not None:
        known = np.isfinite(error).all(axis=1) & np.isfinite(answer.covariance_m2).all(axis=(1, 2))
        solved = np.linalg.solve(answer.covariance_m2[known], error[known][:, :, None])[:, :, 0]
        covered = int(np.sum(np.sum(error[known] * solved, axis=1) <= _REGION_95))
        regions = int(known.sum())
    order = np.argsort(recording.t_s, kind="stable")
    true_m = length_m(recording.true_lat_deg[order], recording.true_lon_deg[order])
    raw_m = length_m(recording.lat_deg[order], recording.lon_deg[order])
    cleaned_m = answer.distance_m
    if cleaned_m is None:
        cleaned_m = length_m(answer.lat_deg[order], answer.lon_deg[order])
    stands = true_m < _STANDS_M
    hours = (recording.t_s[order[-1]] - recording.t_s[order[0]]) / 3600.0
    return Score(
        hits,
        misses,
        alarms,
        good,
        root_mean_square(error),
        root_mean_square(recording.error_m(recording.lat_deg, recording.lon_deg)),
        oracle_m,
        covered,
        regions,
        math.nan if stands else abs(cleaned_m - true_m) / true_m,
        math.nan if stands else abs(raw_m - true_m) / true_m,
        cleaned_m / hours if stands else math.nan,
        seconds,
        len(recording),
    )


def root_mean_square(error_m: FloatArray) -> float:
    """Of vectors, those without numbers left out."""
    return float(np.sqrt(np.nanmean(np.sum(error_m**2, axis=1))))


@dataclass(frozen=True, slots=True)
class Pool:
    """Scores taken together; NaN where nothing was to be counted."""

    scores: Sequence[Score]

    def _sum(self, name: str) -> float:
        return float(sum(getattr(score, name) for score in self.scores))

    @property
    def precision(self) -> float:
        """Faulty rows among the flagged."""
        return _ratio(self._sum("hits"), self._sum("hits") + self._sum("alarms"))

    @property
    def recall(self) -> float:
        """Flagged rows among the faulty."""
        return _ratio(self._sum("hits"), self._sum("hits") + self._sum("misses"))

    @property
    def f1(self) -> float:
        """Harmonic mean of the two; NaN without faulty rows."""
        if self._sum("hits") + self._sum("misses") == 0.0:
            return math.nan
        return _ratio(
            2.0 * self._sum("hits"), 2.0 * self._sum("hits") + self._sum("misses") + self._sum("alarms")
        )

    @property
    def alarm_percent(self) -> float:
        """Good rows that were flagged."""
        return 100.0 * _ratio(self._sum("alarms"), self._sum("good"))

    @property
    def coverage_percent(self) -> float:
        """95 % regions that hold the truth."""
        return 100.0 * _ratio(self._sum("covered"), self._sum("regions"))

    @property
    def over_oracle(self) -> float:
        """Geometric mean of the error over the oracle's."""
        return _geometric_mean(score.rmse_m / score.oracle_m for score in self.scores)

    @property
    def over_raw(self) -> float:
        """Geometric mean of the error over the raw one."""
        return _geometric_mean(score.rmse_m / score.raw_m for score in self.scores)

    @property
    def worst_over_raw(self) -> float:
        """Largest error over the raw one."""
        return max((score.rmse_m / score.raw_m for score in self.scores), default=math.nan)

    @property
    def points_per_second(self) -> float:
        """Rows in a second of processor time."""
        return _ratio(self._sum("points"), self._sum("seconds"))

    def median(self, name: str) -> float:
        """Median of a field, NaN left out."""
        values = [value for score in self.scores if not math.isnan(value := getattr(score, name))]
        return float(np.median(values)) if values else math.nan


def _ratio(part: float, whole: float) -> float:
    return part / whole if whole > 0.0 else math.nan


def _geometric_mean(ratios: Iterable[float]) -> float:
    known = [ratio for ratio in ratios if not math.isnan(ratio)]
    if 0.0 in known:
        return 0.0
    logarithms = [math.log(ratio) for ratio in known]
    return math.exp(float(np.mean(logarithms))) if logarithms else math.nan
