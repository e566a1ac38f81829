"""The benchmark of shapes told from the data."""

import numpy as np
import pytest

from benchmarks.shapes import DRAWS, SHAPES, SHARES, Shape, is_told, make_series, measure, to_markdown


@pytest.mark.parametrize("shape", SHAPES, ids=lambda shape: shape.name)
def test_every_shape_is_told_from_many_clean_points(shape: Shape) -> None:
    t, y = make_series(shape, "uniform", 400, 0.0, np.random.default_rng(3))
    assert y.shape == t.shape == (400,)
    assert is_told(shape, t, y)


def test_another_shape_is_not_counted_as_told() -> None:
    level, _, line, *_ = SHAPES
    t, y = make_series(line, "uniform", 100, 0.0, np.random.default_rng(3))
    assert not is_told(level, t, y)


def test_the_page_has_a_row_for_every_shape_and_a_column_for_every_cell() -> None:
    table = measure(0.001, 1, SHAPES[:1])
    page = to_markdown(table, SHAPES[:1])
    row = next(line for line in page.splitlines() if line.startswith("| level "))
    assert row.count("|") == len(DRAWS) * len(SHARES) + 2
