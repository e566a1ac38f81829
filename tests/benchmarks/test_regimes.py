"""The bed of regimes: what it draws, and the page that it writes."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.regimes import CHANGES, UNCHANGED, Cell, Outcome, draw, measure, to_markdown


@pytest.mark.parametrize("kind", [*UNCHANGED, *CHANGES])
def test_a_draw_depends_on_its_cell_seed_and_index_alone(kind: str) -> None:
    cell = Cell(kind, 100, 0.2, 5)
    one, again, other = draw(cell, 3, 1), draw(cell, 3, 1), draw(cell, 3, 2)
    np.testing.assert_array_equal(one.y, again.y)
    assert (one.y != other.y).any()
    assert (one.last > 0) == (kind in CHANGES)


def test_a_clear_jump_is_counted_as_seen_and_as_placed() -> None:
    assert measure(Cell("jump", 200, 0.0, 3), seed=1) == Outcome(3, 3, 3)


def test_the_page_parts_series_with_changes_from_those_without() -> None:
    page = to_markdown(
        {
            Cell("uniform", 100, 0.0, 20): Outcome(20, 1, 19),
            Cell("uniform", 200, 0.0, 20): Outcome(20, 0, 20),
            Cell("jump", 100, 0.4, 20): Outcome(20, 18, 17),
        }
    )
    same, changed = page.split("## Changes are found")
    assert "| kind | outliers | 100 points | 200 points |" in same
    assert "| uniform | 0 % | 5 | 0 |" in same
    assert "| jump | 40 % | 90 / 85 |" in changed
    assert "20 series" in same
