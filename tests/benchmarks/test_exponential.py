"""The bed of exponentials: what it draws, and what it calls a failure."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.exponential import ALL_KINDS, DOMAINS, OURS, SHARES, failed, make_growth, measure, to_markdown


@pytest.mark.parametrize("domain", DOMAINS)
@pytest.mark.parametrize("kind", ALL_KINDS)
def test_a_draw_has_its_share_of_outliers(domain: str, kind: str) -> None:
    growth = make_growth(domain, kind, 50, 0.4, np.random.default_rng(1))
    assert int(growth.inlier.sum()) == 30
    assert np.isfinite(growth.y).all()


@pytest.mark.parametrize("domain", DOMAINS)
def test_the_truth_does_not_fail_and_a_curve_beside_it_does(domain: str) -> None:
    growth = make_growth(domain, "uniform", 200, 0.2, np.random.default_rng(2))
    truth = growth.truth()
    assert not failed(truth, growth)
    assert failed(truth * 1.3 + 3.0, growth)
    assert failed(np.full(200, np.nan), growth)


def test_clean_series_are_measured_and_written_as_a_page() -> None:
    table = measure(0.01, seed=1, kinds=("uniform",))
    assert {tally.draws for tally in table.values()} == {3}
    assert table["additive", 0.0].percent(OURS) == 0.0
    page = to_markdown(table)
    assert page.count("| additive |") == 6
    assert all(f"{100 * share:.0f} %" in page for share in SHARES)
