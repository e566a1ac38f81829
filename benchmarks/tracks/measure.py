"""Every contender on the same tracks: what is asked, and the scores."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

from benchmarks.tracks.generator import Scenario, record
from benchmarks.tracks.oracle import smooth_knowing
from benchmarks.tracks.recording import Recording
from benchmarks.tracks.scores import Answer, Pool, Score, judge

Clean: TypeAlias = Callable[[Sequence[Recording]], list[tuple[Answer, float] | None]]
"""From recordings to answers with their processor time; None where there is none."""


@dataclass(frozen=True, slots=True)
class Drawn:
    """A recording and the error of the smoother that knows its faults, NaN where nobody does."""

    recording: Recording
    oracle_m: float


@dataclass(frozen=True, slots=True)
class Cell:
    """A contender's scores on one type of track.

    Attributes
    ----------
    track, group, split : str
        Of the scenario; a recorded drive is of the group and the split ``real``.
    contender : str
    scores : tuple of Score
        By seeds.
    unanswered : int
        Tracks without an answer; the raw track is scored in its place.
    """

    track: str
    group: str
    split: str
    contender: str
    scores: tuple[Score, ...]
    unanswered: int


def pool(cells: Sequence[Cell], **wanted: str) -> Pool:
    """Take together the scores of the cells with these attributes.

    Examples
    --------
    >>> pool([], group="clean", split="tune").scores
    ()
    """
    chosen = [cell for cell in cells if all(getattr(cell, name) == value for name, value in wanted.items())]
    return Pool(tuple(score for cell in chosen for score in cell.scores))


def draw(scenario: Scenario, seeds: int) -> list[Drawn]:
    """Draw tracks of a type, of the seeds 1, 2, ..."""
    recordings = [record(scenario, seed) for seed in range(1, seeds + 1)]
    return [Drawn(recording, smooth_knowing(recording)) for recording in recordings]


def ask(clean: Clean, drawn: Sequence[Drawn]) -> list[tuple[Score, bool]]:
    """Scores of a contender, and whether it gave an answer; if not, the raw track is scored."""
    scores = []
    for one, answered in zip(drawn, clean([one.recording for one in drawn]), strict=True):
        raw = Answer(one.recording.lat_deg, one.recording.lon_deg)
        answer, seconds = (raw, 0.0) if answered is None else answered
        scores.append((judge(one.recording, answer, one.oracle_m, seconds), answered is not None))
    return scores


def measure_scenarios(
    scenarios: Sequence[Scenario],
    ours: Mapping[str, Clean],
    others: Mapping[str, Clean],
    seeds: int,
    other_seeds: int,
    say: Callable[[str], None],
) -> list[Cell]:
    """Ask every contender about every type.

    Parameters
    ----------
    scenarios : sequence of Scenario
    ours : mapping
        Contenders by name that are asked about all seeds.
    others : mapping
        Contenders that are asked about the first of them only.
    seeds, other_seeds : int
    say : callable
        Told of progress.
    """
    drawn = [draw(scenario, seeds) for scenario in scenarios]
    cells: dict[tuple[str, str], Cell] = {}
    for contenders, count in ((ours, seeds), (others, other_seeds)):
        for name, clean in contenders.items():
            say(name)
            # All at once: peers are programs that take seconds to start.
            scores = ask(clean, [one for tracks in drawn for one in tracks[:count]])
            for k, scenario in enumerate(scenarios):
                own = scores[k * count : (k + 1) * count]
                cells[scenario.name, name] = _cell(scenario.name, scenario.group, scenario.split, name, own)
    return [cells[scenario.name, name] for scenario in scenarios for name in (*ours, *others)]


def _cell(track: str, group: str, split: str, contender: str, answered: Sequence[tuple[Score, bool]]) -> Cell:
    unanswered = sum(not there for _, there in answered)
    return Cell(track, group, split, contender, tuple(score for score, _ in answered), unanswered)


def measure_drives(
    drives: Sequence[Recording], contenders: Mapping[str, Clean], say: Callable[[str], None]
) -> list[Cell]:
    """Ask every contender about recorded drives."""
    cells = []
    for name, clean in contenders.items():
        say(f"recorded drives: {name}")
        answered = ask(clean, [Drawn(recording, math.nan) for recording in drives])
        for recording, one in zip(drives, answered, strict=True):
            cells.append(_cell(recording.name, "real", "real", name, [one]))
    return cells


def leave_raw(recordings: Sequence[Recording]) -> list[tuple[Answer, float] | None]:
    """Hand the tracks back as they came: what every cleaner has to better."""
    return [(Answer(recording.lat_deg, recording.lon_deg), 0.0) for recording in recordings]
