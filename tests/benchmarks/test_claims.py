import math

import pytest

from benchmarks.bed import true_inliers
from benchmarks.cells import Cell
from benchmarks.claims import Claim, check_claims, claim_cells, measure_claims
from benchmarks.kinds import KINDS


@pytest.mark.parametrize(
    ("reached", "holds"), [(1.9, "yes"), (2.0, "yes"), (2.7, "within error"), (3.1, "no"), (math.nan, "no")]
)
def test_a_claim_missed_by_less_than_two_standard_errors_is_undecided(reached: float, holds: str) -> None:
    assert Claim("failure %", reached, 0.0, 2.0, 0.5).holds == holds


@pytest.mark.parametrize(
    ("low", "high", "wanted"), [(0.0, 2.0, "≤ 2"), (0.91, 1.0, "≥ 0.91"), (0.93, 0.98, "0.93 to 0.98")]
)
def test_a_claim_says_what_it_wants(low: float, high: float, wanted: str) -> None:
    assert Claim("", 1.0, low, high, 0.0).wanted == wanted


def test_every_cell_has_at_least_ten_true_inliers() -> None:
    cells = claim_cells(1, 1)
    assert min(true_inliers(cell.kind, cell.n, cell.share) for cell in cells) >= 10
    assert Cell("burst", 50, 0.8, 1) in cells
    assert Cell("burst", 50, 0.9, 1) not in cells
    assert Cell("step", 50, 0.8, 1) not in cells


def test_cells_that_a_claim_rests_on_get_all_draws_and_the_other_families_their_own() -> None:
    draws = {(cell.kind, cell.n, cell.share): cell.draws for cell in claim_cells(8, 2)}
    assert draws["burst", 200, 0.4] == draws["step", 200, 0.0] == draws["ar1_0.5", 200, 0.2] == 8
    assert draws["step", 200, 0.2] == draws["clumps", 50, 0.4] == 2
    assert {cell.kind for cell in claim_cells(8, 0)} == {*KINDS, "step", "ar1_0.5", "ar1_0.8"}


def test_a_few_draws_of_the_bed_are_enough_to_check_every_claim() -> None:
    results = measure_claims(1, family_draws=0, seed=3, jobs=1)
    claims = check_claims(results)
    assert {kind for kind, _, _ in results} > set(KINDS)
    assert len({claim.text for claim in claims}) == len(claims) == 14
