"""``python -m benchmarks``: measure everything and rewrite ``docs/benchmarks.md`` and its picture."""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable
from pathlib import Path

from benchmarks.accuracy import measure_bed
from benchmarks.claims import check_claims, measure_claims
from benchmarks.contenders import OURS
from benchmarks.footprint import FITS, measure_footprints
from benchmarks.peers import PEERS, SKIMAGE_STOP_99, SLOWEST
from benchmarks.report import Measured, write_report
from benchmarks.speed import SIZES, check_speed, measure_passes, measure_speed
from benchmarks.traps import measure_traps

DOCS = Path(__file__).resolve().parent.parent / "docs"


def main(arguments: list[str] | None = None) -> int:
    """Command line."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument(
        "--quick", action="store_true", help="a smoke run: few draws, small series, no slow peer"
    )
    parser.add_argument("--out", type=Path, default=DOCS, help="folder of benchmarks.md (default: docs)")
    parser.add_argument("--jobs", type=int, default=2, help="processes that measure accuracy (default 2)")
    parser.add_argument("--seed", type=int, default=1, help="seed of the draws (default 1)")
    chosen = parser.parse_args(arguments)
    say = _progress(sys.stderr.isatty())
    page = write_report(measure(quick=chosen.quick, seed=chosen.seed, jobs=chosen.jobs, say=say), chosen.out)
    say(f"wrote {page}")
    sys.stderr.write("\n")
    return 0


def measure(*, quick: bool, seed: int, jobs: int, say: Callable[[str], None]) -> Measured:
    """Run every benchmark. Speed comes first and alone: the others keep all cores busy."""
    contenders = tuple(entry for entry in OURS + PEERS if not (quick and entry.name in SLOWEST))
    timed = (*contenders, SKIMAGE_STOP_99)
    sizes = {200: 1} if quick else SIZES
    speeds = {
        n: measure_speed(n, contenders=timed, seed=seed, repetitions=repetitions, progress=say)
        for n, repetitions in sizes.items()
    }
    passes = measure_passes(seed=seed, n=20_000 if quick else 1_000_000, draws=1 if quick else 3)
    say("start and memory")
    names = list(FITS)[:1] if quick else list(FITS)
    footprints = measure_footprints(names, starts=1 if quick else 5, points=50_000 if quick else 1_000_000)
    trap_draws = 1 if quick else 20
    say("numeric traps")
    traps = measure_traps(contenders, seed=seed, draws=trap_draws)
    accuracy = measure_bed(contenders, seed=seed, scale=0.01 if quick else 1.0, jobs=jobs, progress=say)
    claim_draws, family_draws = (1, 1) if quick else (1000, 250)
    results = measure_claims(claim_draws, family_draws=family_draws, seed=seed + 1, jobs=jobs, progress=say)
    claims = [*check_claims(results), *check_speed(speeds, passes, footprints)]
    return Measured(
        accuracy, claims, results, claim_draws, family_draws, traps, trap_draws, speeds, passes, footprints
    )


def _progress(terminal: bool) -> Callable[[str], None]:
    """Progress on one line of a terminal; into a file, a line at most every ten seconds."""
    last = -10.0

    def say(text: str) -> None:
        nonlocal last
        if terminal:
            sys.stderr.write(f"\r{text:<78}")
            sys.stderr.flush()
        elif time.monotonic() - last >= 10.0:
            last = time.monotonic()
            sys.stderr.write(f"{text}\n")

    return say


if __name__ == "__main__":
    sys.exit(main())
