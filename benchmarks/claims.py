"""The accuracy that Plumbline claims for ``auto``, measured: ``python -m benchmarks.claims --draws 1000``.

Prints a table *claim / reached / holds* and every cell that breaks a claim. A claim that is missed by less
than two binomial standard errors is marked ``within error``: the draws cannot tell.
"""

from __future__ import annotations

import argparse
import math
import sys
import time
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from benchmarks.accuracy import DRAWS, LEAST_INLIERS, NORMAL_KINDS, SHARES
from benchmarks.bed import FAMILIES, KINDS, true_inliers
from benchmarks.cells import Cell, Outcomes, measure_all, pool
from benchmarks.contenders import AUTO

SIZES = DRAWS
"""Sizes, and how they are weighted when a cell pools them."""
CORRELATED = tuple(kind for kind in FAMILIES if kind.startswith("ar1"))
CORRELATED_SIZES = (80, 200, 1000)
RMS_LIMITS = {0.0: 1.10, 0.2: 1.10, 0.4: 1.15, 0.6: 1.20}
FAMILY_SHARES = SHARES[:5]

Results = Mapping[tuple[str, int, float], Outcomes]


@dataclass(frozen=True, slots=True)
class Claim:
    """One line of the table.

    Attributes
    ----------
    text : str
    reached : float
    low, high : float
        What is claimed of ``reached``.
    error : float
        Standard error of ``reached``.
    cells : tuple of str
        The cells that break the claim.
    """

    text: str
    reached: float
    low: float
    high: float
    error: float
    cells: tuple[str, ...] = ()

    @property
    def wanted(self) -> str:
        """What is claimed, as people write it."""
        if self.low <= 0.0:
            return f"≤ {self.high:g}"
        if self.high >= 1.0:
            return f"≥ {self.low:g}"
        return f"{self.low:g} to {self.high:g}"

    @property
    def holds(self) -> str:
        """``yes``, ``within error`` or ``no``."""
        if self.low <= self.reached <= self.high:
            return "yes"
        if self.low - 2 * self.error <= self.reached <= self.high + 2 * self.error:
            return "within error"
        return "no"


def claim_cells(draws: int, family_draws: int) -> list[Cell]:
    """Return the cells that the claims need, and those of the families that nobody claims anything about.

    Parameters
    ----------
    draws : int
        Per cell that a claim rests on.
    family_draws : int
        Per other cell; 0 leaves them out.
    """
    claimed = [(kind, n, share) for kind in KINDS for share in SHARES for n in SIZES]
    claimed += [("step", n, 0.0) for n in SIZES]
    claimed += [
        (kind, n, share) for kind in CORRELATED for share in (0.0, 0.2, 0.4) for n in CORRELATED_SIZES
    ]
    others = [(kind, n, share) for kind in FAMILIES for share in FAMILY_SHARES for n in SIZES]
    wanted = dict.fromkeys(claimed, draws)
    if family_draws > 0:
        wanted = dict.fromkeys(others, family_draws) | wanted
    return [Cell(*key, count) for key, count in wanted.items() if true_inliers(*key) >= LEAST_INLIERS]


def measure_claims(
    draws: int,
    *,
    family_draws: int,
    seed: int,
    jobs: int,
    progress: Callable[[str], None] | None = None,
) -> Results:
    """Measure ``auto`` on every cell."""
    cells = claim_cells(draws, family_draws)
    measured = measure_all((AUTO,), cells, seed=seed, jobs=jobs, progress=progress)
    return {(cell.kind, cell.n, cell.share): outcomes[0] for cell, outcomes in measured.items()}


def pooled_fail(results: Results, kind: str, share: float) -> float:
    """Failures in percent of a kind at a share, sizes weighted 60 : 40 : 25."""
    known = [(weight, (kind, n, share)) for n, weight in SIZES.items() if (kind, n, share) in results]
    if not known:
        return math.nan
    total = sum(weight for weight, _ in known)
    return sum(weight * results[key].fail_percent() for weight, key in known) / total


def check_claims(results: Results) -> list[Claim]:
    """Hold every claim against what was measured."""
    return [
        _mean_failure(results),
        _worst_failure(results),
        *(_one_failure(results, kind, 0.8, 20.0, f"{kind} at 80 %") for kind in ("shift", "burst")),
        _one_failure(results, "step", 0.0, 10.0, "step of the level at 40 % of the span"),
        *(_rms(results, share, limit) for share, limit in RMS_LIMITS.items()),
        _flag_f1(results),
        _coverage(results, "N >= 200", 0.93, 0.98, _bed_cells(results, lambda n: n >= 200)),
        _coverage(results, "N = 50", 0.91, 1.0, _bed_cells(results, lambda n: n == 50)),
        *(
            _coverage(
                results, f"AR(1) up to 0.8, N >= 80, {label}", 0.91, 1.0, _correlated_cells(results, shares)
            )
            for label, shares in (("clean", (0.0,)), ("20 and 40 % outliers", (0.2, 0.4)))
        ),
    ]


def _mean_failure(results: Results) -> Claim:
    cells = [pooled_fail(results, kind, share) for kind in KINDS for share in SHARES if share > 0]
    return Claim("mean failure %, kinds x shares", float(np.nanmean(cells)), 0.0, 10.0, 0.0)


def _worst_failure(results: Results) -> Claim:
    rates = {
        (kind, share): pooled_fail(results, kind, share) for kind in KINDS for share in SHARES if share <= 0.6
    }
    kind, share = max(rates, key=lambda key: rates[key])
    text = f"failure % of the worst kind up to 60 % outliers ({kind} at {share:.0%})"
    broken = tuple(
        f"{kind} {share:.0%}: {rate:.2f} % ({_by_size(results, kind, share)})"
        for (kind, share), rate in rates.items()
        if rate > 2.0
    )
    return Claim(text, rates[kind, share], 0.0, 2.0, _rate_error(results, kind, share, 2.0), broken)


def _one_failure(results: Results, kind: str, share: float, limit: float, text: str) -> Claim:
    rate = pooled_fail(results, kind, share)
    detail = (f"{kind} {share:.0%}: {_by_size(results, kind, share)}",) if rate > limit else ()
    return Claim(f"failure %, {text}", rate, 0.0, limit, _rate_error(results, kind, share, limit), detail)


def _rms(results: Results, share: float, limit: float) -> Claim:
    ratios = {kind: _pooled(results, kind, share).rms_over_oracle() for kind in NORMAL_KINDS}
    broken = tuple(f"{kind} {share:.0%}: {ratio:.3f}" for kind, ratio in ratios.items() if ratio > limit)
    mean = float(np.mean(list(ratios.values())))
    return Claim(f"RMS over oracle at {share:.0%} outliers", mean, 0.0, limit, 0.0, broken)


def _flag_f1(results: Results) -> Claim:
    cells = {
        (kind, share): _pooled(results, kind, share).mean_f1()
        for kind in KINDS
        for share in SHARES
        if share > 0
    }
    lowest = sorted(cells.items(), key=lambda item: item[1])[:3]
    detail = tuple(f"{kind} {share:.0%}: {value:.3f}" for (kind, share), value in lowest)
    reached = float(np.nanmean(list(cells.values())))
    return Claim(
        "flag F1, mean over kinds x shares", reached, 0.945, 1.0, 0.0, () if reached >= 0.945 else detail
    )


def _coverage(
    results: Results, text: str, low: float, high: float, keys: list[tuple[str, int, float]]
) -> Claim:
    """Coverage of the cell that is farthest outside of (or nearest to the edge of) what is claimed."""
    # Where every draw failed there is no interval to speak of: that breaks any claim.
    rates = {key: float(np.nan_to_num(results[key].coverage())) for key in keys}
    room = {key: rate - low if high >= 1.0 else min(rate - low, high - rate) for key, rate in rates.items()}
    worst = min(room, key=lambda key: room[key])
    draws = int(np.count_nonzero(~results[worst].failed))
    kind, n, share = worst
    broken = tuple(
        f"{kind} N={n} {share:.0%}: {rate:.3f}"
        for (kind, n, share), rate in rates.items()
        if not low <= rate <= high
    )
    label = f"coverage of the 95 % slope interval, {text}, worst cell ({kind} N={n} {share:.0%})"
    edge = low if rates[worst] < low else high
    return Claim(label, rates[worst], low, high, math.sqrt(edge * (1.0 - edge) / max(draws, 1)), broken)


def _bed_cells(results: Results, wanted: Callable[[int], bool]) -> list[tuple[str, int, float]]:
    return [
        (kind, n, share)
        for kind, n, share in results
        if kind in KINDS and wanted(n) and share <= (0.2 if kind == "line2" else 0.6)
    ]


def _correlated_cells(results: Results, shares: Iterable[float]) -> list[tuple[str, int, float]]:
    wanted = set(shares)
    return [
        key for key in results if key[0] in CORRELATED and key[1] in CORRELATED_SIZES and key[2] in wanted
    ]


def _pooled(results: Results, kind: str, share: float) -> Outcomes:
    return pool([results[kind, n, share] for n in SIZES if (kind, n, share) in results])


def _by_size(results: Results, kind: str, share: float) -> str:
    known = [n for n in SIZES if (kind, n, share) in results]
    return ", ".join(f"N={n}: {results[kind, n, share].fail_percent():.1f}" for n in known)


def _rate_error(results: Results, kind: str, share: float, percent: float) -> float:
    rate = percent / 100.0
    draws = sum(results[kind, n, share].inliers.size for n in SIZES if (kind, n, share) in results)
    return 100.0 * math.sqrt(rate * (1.0 - rate) / max(draws, 1))


def family_table(results: Results, kinds: Iterable[str], shares: Iterable[float]) -> list[list[str]]:
    """Failures in percent, one row per kind and one column per share."""
    wanted = tuple(shares)
    return [
        [
            kind,
            *(
                "-" if math.isnan(rate := pooled_fail(results, kind, share)) else f"{rate:.1f}"
                for share in wanted
            ),
        ]
        for kind in kinds
    ]


def main() -> int:
    """Command line; the exit status is 1 if a claim does not hold."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.claims", description="Measure Plumbline's claims."
    )
    parser.add_argument("--draws", type=int, default=1000, help="draws per cell (default 1000)")
    parser.add_argument("--seed", type=int, default=20_000, help="seed of the draws (default 20000)")
    parser.add_argument("--jobs", type=int, default=2, help="processes (default 2)")
    parser.add_argument(
        "--family-draws", type=int, help="draws per cell of the other families (default: draws / 4)"
    )
    parser.add_argument("--bed-only", action="store_true", help="leave the other families out")
    chosen = parser.parse_args()
    started = time.perf_counter()
    wanted = -(-chosen.draws // 4) if chosen.family_draws is None else chosen.family_draws
    family_draws = 0 if chosen.bed_only else wanted
    results = measure_claims(chosen.draws, family_draws=family_draws, seed=chosen.seed, jobs=chosen.jobs)
    claims = check_claims(results)
    sys.stdout.write(text_report(results, claims))
    sys.stdout.write(f"\n{chosen.draws} draws per cell, {time.perf_counter() - started:.0f} s\n")
    return int(any(claim.holds == "no" for claim in claims))


def text_report(results: Results, claims: Iterable[Claim]) -> str:
    """Return the whole report as plain text."""
    lines = [f"{'claim':<96}{'reached':>9}  holds"]
    for claim in claims:
        lines.append(f"{claim.text + ' ' + claim.wanted:<96}{claim.reached:>9.3f}  {claim.holds}")
        lines.extend(f"      {cell}" for cell in claim.cells)
    lines.append("\nfailure %        " + "".join(f"{share:>7.0%}" for share in SHARES))
    for kind, *rates in family_table(results, (*KINDS, *FAMILIES), SHARES):
        lines.append(f"{kind:<17}" + "".join(f"{rate:>7}" for rate in rates))
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    sys.exit(main())
