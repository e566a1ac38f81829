"""What is known of a live track between two calls: the fixes held, which of them are settled, and the noise.

Fixes are held in order of time: first settled ones, which are context, then open ones. Everything that
happens is a function of the fixes that have arrived, one after the other, and never of how they were cut
into calls.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal, NamedTuple, TypeAlias

from estimators.trajectories.parameters import TrackParameters

MOST_HELD = 512
"""Fixes held: what noise and motion are estimated from."""
LAGS = (4, 128)
"""Least and greatest delay, in fixes."""

TimeKind: TypeAlias = Literal["none", "number", "datetime"]
"""Of the caller's times; ``none`` before the first."""

START = TrackParameters(4.0, 1.0, 1.0)
"""Before anything is estimated: the means of the priors."""


class Fix(NamedTuple):
    """A row with a time.

    Attributes
    ----------
    row : int
        Its number in the stream, from 0.
    stamp : int or float
        The caller's time: nanoseconds of points in time, else the number.
    lat, lon : float
        Degrees; NaN where there is no place on Earth.
    height, accuracy : float
        With the digits of 32 bits; NaN where there is none.
    """

    row: int
    stamp: int | float
    lat: float
    lon: float
    height: float
    accuracy: float


@dataclass(frozen=True, slots=True)
class Settings:
    """What the caller set when the track began.

    Attributes
    ----------
    lag : int
    sigma_m, max_speed_mps : float or None
    """

    lag: int
    sigma_m: float | None
    max_speed_mps: float | None


@dataclass(slots=True)
class Stream:
    """State of a live track.

    Attributes
    ----------
    settings : Settings
    kind : {"none", "number", "datetime"}
    received : int
        Rows so far, of any kind.
    taken : int
        Fixes taken into the order of time so far.
    late : int
        Rows on end that came too late.
    held : list of Fix
        In order of time.
    settled : int
        So many of the first of them are settled.
    good : list of bool
        Of the settled ones: whether they tell where the track was.
    parameters : TrackParameters
    typical_accuracy : float
        Median of what the receiver reports; NaN while noise is not measured in units of it.
    """

    settings: Settings
    kind: TimeKind = "none"
    received: int = 0
    taken: int = 0
    late: int = 0
    held: list[Fix] = field(default_factory=list)
    settled: int = 0
    good: list[bool] = field(default_factory=list)
    parameters: TrackParameters = START
    typical_accuracy: float = float("nan")

    @property
    def open(self) -> int:
        """Fixes that are not settled."""
        return len(self.held) - self.settled

    def seconds_between(self, earlier: Fix, later: Fix) -> float:
        """Seconds from one fix to another."""
        apart = later.stamp - earlier.stamp
        return apart / 1e9 if self.kind == "datetime" else float(apart)

    def forget_oldest(self) -> None:
        """Drop context beyond what may be held."""
        spare = self.settled - (MOST_HELD - self.settings.lag)
        if spare > 0:
            del self.held[:spare], self.good[:spare]
            self.settled -= spare

    def begin_anew(self) -> None:
        """Forget all fixes, and keep what is known of the noise."""
        self.held.clear()
        self.good.clear()
        self.settled = 0
        self.late = 0
