"""``python -m benchmarks.positions``: measure everything and rewrite ``docs/benchmarks_positions.md``."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from benchmarks.positions.cells import all_beds, measure_bed, measure_protection, warm_up
from benchmarks.positions.clean import measure_clean
from benchmarks.positions.page import describe_versions, write_page
from benchmarks.positions.peers import peer_version
from benchmarks.positions.rtklib import is_present
from benchmarks.positions.sky import OPEN_SKIES, data_folder

DOCS = Path(__file__).resolve().parents[2] / "docs"


def main(arguments: Sequence[str] | None = None) -> int:
    """Command line."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.positions", description=__doc__)
    parser.add_argument("--epochs", type=int, default=120, help="epochs of a cell, at most (default 120)")
    parser.add_argument(
        "--protection", type=int, default=3000, help="epochs of a row of protection levels (default 3000)"
    )
    parser.add_argument("--seed", type=int, default=1, help="seed of the faults (default 1)")
    parser.add_argument("--out", type=Path, default=DOCS, help="folder of the page (default: docs)")
    chosen = parser.parse_args(arguments)
    data = data_folder()
    if not data.is_dir():
        parser.error("the published data sets are not here; PLUMBLINE_TEST_DATA says where they are")

    def say(text: str) -> None:
        sys.stderr.write(f"{text}\n")

    beds = all_beds(data, chosen.epochs, chosen.seed)
    warm_up(beds)
    cells = [cell for bed in beds for cell in measure_bed(bed, chosen.seed, say)]
    clean = measure_clean(OPEN_SKIES, data, say)
    protection = measure_protection(chosen.protection, chosen.seed, say)
    versions = describe_versions(is_present(), peer_version("sidereon"), peer_version("gnss_lib_py"))
    say(f"wrote {write_page(cells, clean, protection, versions, chosen.out)}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
