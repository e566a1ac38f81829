"""From what was measured to ``docs/benchmarks.md`` and its picture: ratios and rates, no machine, no date.

The prose is in ``page.md`` beside this file; here its tables are filled in.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from string import Template

from benchmarks.accuracy import DRAWS, NORMAL_KINDS, SHARES, Accuracy
from benchmarks.bed import FAMILIES, KINDS
from benchmarks.cells import Outcomes
from benchmarks.claims import Claim, Results, family_table
from benchmarks.contenders import AUTO, MSAC, Contender
from benchmarks.figure import save_failures
from benchmarks.footprint import Footprint
from benchmarks.speed import Passes, SpeedTable
from benchmarks.traps import TRAPS
from estimators.arrays import FloatArray

PEER_PACKAGES = ("scikit-learn", "scikit-image", "scipy", "statsmodels", "numpy", "numba")
COVERED_SHARES = SHARES[:4]
PAGE = Path(__file__).with_name("page.md")


@dataclass(frozen=True, slots=True)
class Measured:
    """Everything that a run of the benchmarks measured."""

    accuracy: Accuracy
    claims: Sequence[Claim]
    claim_results: Results
    claim_draws: int
    family_draws: int
    traps: FloatArray
    trap_draws: int
    speeds: Mapping[int, SpeedTable]
    passes: Passes
    footprints: Mapping[str, Footprint]


def write_report(measured: Measured, folder: Path) -> Path:
    """Write ``benchmarks.md`` and ``images/benchmark_failures.svg`` into a folder.

    Parameters
    ----------
    measured : Measured
    folder : pathlib.Path
        Made if it is missing.

    Returns
    -------
    pathlib.Path
        The page.
    """
    (folder / "images").mkdir(parents=True, exist_ok=True)
    save_failures(measured.accuracy, folder / "images" / "benchmark_failures.svg")
    page = folder / "benchmarks.md"
    page.write_text(_page(measured), encoding="utf-8")
    return page


def table(header: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Markdown table; the first column is text, the others are numbers."""
    lines = [header, ["---", *["---:"] * (len(header) - 1)], *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def _page(measured: Measured) -> str:
    largest = measured.speeds[max(measured.speeds)]
    blanks = {
        "versions": ", ".join(f"{name} {version(name)}" for name in PEER_PACKAGES),
        "draws": f"{sum(DRAWS.values())}",
        "failures": _failures(measured.accuracy),
        "by_kind": _by_kind(measured.accuracy),
        "rms": _shares_table(measured.accuracy, Outcomes.rms_over_oracle, NORMAL_KINDS, 2),
        "coverage": _shares_table(measured.accuracy, Outcomes.coverage, tuple(KINDS), 3),
        "families": _families(measured.claim_results),
        "traps": _traps(measured),
        "trap_draws": f"{measured.trap_draws}",
        "speed": _speed(measured.speeds),
        "passes_points": f"{measured.passes.n:,}",
        "passes_median": _number(measured.passes.median),
        "passes_worst": _number(measured.passes.worst),
        "passes_kind": measured.passes.worst_kind,
        "largest": f"{largest.n:,}",
        "sklearn_wall": _wall(largest, "scikit-learn RANSACRegressor"),
        "skimage_wall": _wall(largest, "scikit-image ransac"),
        "footprints": _footprints(measured.footprints),
        "family_draws": f"{measured.family_draws:,}",
        "claim_draws": f"{measured.claim_draws:,}",
        "claims": _claims(measured.claims),
    }
    return Template(PAGE.read_text(encoding="utf-8")).substitute(blanks)


def _failures(accuracy: Accuracy) -> str:
    header = ["method", "threshold", "mean", *(f"{share:.0%}" for share in SHARES), "F1"]
    rows = []
    for index in sorted(range(len(accuracy.contenders)), key=accuracy.mean_fail):
        rates = accuracy.by_share(index, Outcomes.fail_percent)
        figures = [accuracy.mean_fail(index), *rates]
        contender = accuracy.contenders[index]
        rows.append(
            [
                _name(contender),
                _told(contender),
                *(_percent(figure) for figure in figures),
                _fixed(accuracy.mean_f1(index), 3),
            ]
        )
    return table(header, rows)


def _by_kind(accuracy: Accuracy) -> str:
    index = accuracy.contenders.index(AUTO)
    rows = [
        [kind, *(_percent(accuracy.table[kind, share][index].fail_percent()) for share in SHARES)]
        for kind in KINDS
    ]
    return table(["kind", *(f"{share:.0%}" for share in SHARES)], rows)


def _shares_table(
    accuracy: Accuracy, figure: Callable[[Outcomes], float], kinds: Sequence[str], digits: int
) -> str:
    """Mean of a figure over kinds up to 60 % outliers, for those who have one."""
    rows = []
    for index, contender in enumerate(accuracy.contenders):
        values = accuracy.by_share(index, figure, kinds)[: len(COVERED_SHARES)]
        if not all(math.isnan(value) for value in values):
            rows.append([_name(contender), _told(contender), *(_fixed(value, digits) for value in values)])
    return table(["method", "threshold", *(f"{share:.0%}" for share in COVERED_SHARES)], rows)


def _families(results: Results) -> str:
    shares = SHARES[:5]
    return table(["family", *(f"{share:.0%}" for share in shares)], family_table(results, FAMILIES, shares))


def _traps(measured: Measured) -> str:
    rows = [
        [_name(contender), *(f"{rate:.0f}" for rate in measured.traps[index])]
        for index, contender in enumerate(measured.accuracy.contenders)
    ]
    return table(["method", *TRAPS], rows)


def _speed(speeds: Mapping[int, SpeedTable]) -> str:
    contenders = list(next(iter(speeds.values())).timings)
    rows = []
    for contender in contenders:
        cells = [
            f"{_number(speed.ratio(contender, AUTO))} ({_number(speed.ratio(contender, MSAC))})"
            if contender in speed.timings
            else "-"
            for speed in speeds.values()
        ]
        rows.append([_name(contender), _told(contender), *cells])
    return table(["method", "threshold", *(f"N = {n:,}" for n in speeds)], rows)


def _wall(speed: SpeedTable, name: str) -> str:
    rivals = [contender for contender in speed.timings if contender.name == name]
    return _number(min(speed.ratio(rival, AUTO, "wall") for rival in rivals))


def _footprints(footprints: Mapping[str, Footprint]) -> str:
    rows = [
        [name, _number(cost.start_in_numpy_imports), f"{cost.memory_points:,}", _number(cost.memory_in_data)]
        for name, cost in footprints.items()
    ]
    return table(["method", "start to first fit", "points", "memory"], rows)


def _claims(claims: Sequence[Claim]) -> str:
    rows = [[claim.text, claim.wanted, _number(claim.reached), claim.holds] for claim in claims]
    return table(["claim", "claimed", "reached", "holds"], rows)


def _name(contender: Contender) -> str:
    return f"**{contender.name}**" if contender.name.startswith("Plumbline") else contender.name


def _told(contender: Contender) -> str:
    return "given" if contender.knows_threshold else "-"


def _percent(value: float) -> str:
    return _fixed(value, 1)


def _fixed(value: float, digits: int) -> str:
    return "-" if math.isnan(value) else f"{value:.{digits}f}"


def _number(value: float) -> str:
    """Three significant digits, without an exponent."""
    if math.isnan(value):
        return "-"
    if value == 0.0 or not math.isfinite(value):
        return f"{value:g}"
    digits = max(0, 2 - math.floor(math.log10(abs(value))))
    return f"{value:,.{digits}f}"
