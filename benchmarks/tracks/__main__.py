"""``python -m benchmarks.tracks``: measure everything and rewrite the page and its pictures."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path

from benchmarks.tracks.figure import save_errors
from benchmarks.tracks.generator import Scenario, record
from benchmarks.tracks.maps import LOOKED_AT, SHOWN, save_maps
from benchmarks.tracks.measure import Clean, leave_raw, measure_drives, measure_scenarios
from benchmarks.tracks.ours import answer_by
from benchmarks.tracks.page import OURS, RAW, Measured, write_page
from benchmarks.tracks.peers import PEERS, answer_by_peer, find_peer
from benchmarks.tracks.real import data_folder, present_drives
from benchmarks.tracks.recording import Recording
from benchmarks.tracks.scenarios import SCENARIOS
from benchmarks.tracks.scores import Answer
from estimators import track_methods

DOCS = Path(__file__).resolve().parents[2] / "docs"


def main(arguments: Sequence[str] | None = None) -> int:
    """Command line."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.tracks", description=__doc__)
    parser.add_argument("--seeds", type=int, default=20, help="tracks of a type for auto (default 20)")
    parser.add_argument("--other-seeds", type=int, default=2, help="the same for other methods (default 2)")
    parser.add_argument(
        "--only", default="", help="types whose name, group or split holds this text (default: all)"
    )
    parser.add_argument("--out", type=Path, default=DOCS, help="folder of the page (default: docs)")
    parser.add_argument(
        "--maps", type=Path, help="draw ten maps into this folder for looking at, and measure nothing"
    )
    chosen = parser.parse_args(arguments)
    if not 1 <= chosen.other_seeds <= chosen.seeds:
        parser.error("--other-seeds must be at least 1 and at most --seeds")
    if chosen.maps is not None:
        draw_maps(chosen.maps)
        return 0
    scenarios = [s for s in SCENARIOS.values() if chosen.only in (f"{s.name}; {s.group}; {s.split}")]
    if not scenarios:
        parser.error("no type of track is called so")
    page = run(scenarios, chosen.seeds, chosen.other_seeds, chosen.out, say)
    say(f"wrote {page}")
    return 0


def say(text: str) -> None:
    """Tell of progress."""
    sys.stderr.write(f"{text}\n")


def run(
    scenarios: Sequence[Scenario], seeds: int, other_seeds: int, folder: Path, tell: Callable[[str], None]
) -> Path:
    """Measure, and write the page and its pictures.

    Parameters
    ----------
    scenarios : sequence of Scenario
    seeds, other_seeds : int
    folder : pathlib.Path
    tell : callable
        Told of progress.
    """
    answer_by("auto", record(scenarios[0], 0))  # No figure is to hold a compilation.
    ours: dict[str, Clean] = {OURS: partial(_all_by, "auto")}
    others: dict[str, Clean] = {
        f"Plumbline {name}": partial(_all_by, name) for name in track_methods() if name != "auto"
    }
    others[RAW] = leave_raw
    versions: dict[str, None] = {}
    for title, peer in PEERS.items():
        found = find_peer(peer)
        if found is None:
            versions[f"{title}: absent"] = None
            continue
        python, version = found
        versions[f"{peer.package} {version}"] = None
        others[title] = partial(answer_by_peer, python, peer)
    cells = measure_scenarios(scenarios, ours, others, seeds, other_seeds, tell)
    drives = measure_drives(present_drives(data_folder()), ours | others, tell)
    images = folder / "images"
    images.mkdir(parents=True, exist_ok=True)
    save_errors(cells, images / "benchmark_tracks.svg")
    save_maps([_looked_at(name) for name in SHOWN], images / "benchmark_tracks_maps.png")
    return write_page(Measured(cells, drives, seeds, other_seeds, list(versions)), folder)


def draw_maps(folder: Path) -> None:
    """Draw a map of one track of each type to look at, and of the recorded drives."""
    folder.mkdir(parents=True, exist_ok=True)
    pairs = [_looked_at(name) for name in LOOKED_AT]
    pairs += [(drive, answer_by("auto", drive)[0]) for drive in present_drives(data_folder())]
    for k, pair in enumerate(pairs):
        path = folder / f"{k + 1:02d}.png"
        save_maps([pair], path)
        say(f"{path}: {pair[0].name}")


def _looked_at(name: str) -> tuple[Recording, Answer]:
    recording = record(SCENARIOS[name], 1)
    return recording, answer_by("auto", recording)[0]


def _all_by(method: str, recordings: Sequence[Recording]) -> list[tuple[Answer, float] | None]:
    return [answer_by(method, recording) for recording in recordings]


if __name__ == "__main__":
    sys.exit(main())
