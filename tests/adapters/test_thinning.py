from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from estimators.adapters.thinning import one_per_cell

COORDINATES = st.integers(0, 60).flatmap(
    lambda count: st.tuples(
        *(hnp.arrays(np.float64, count, elements=st.floats(-1e300, 1e300)) for _ in range(2)),
    )
)


@given(COORDINATES, st.integers(1, 9), st.integers(1, 9))
def test_what_is_kept_is_a_sorted_choice_of_at_most_one_per_cell(
    points: tuple[np.ndarray, np.ndarray], columns: int, rows: int
) -> None:
    kept = one_per_cell(*points, columns, rows)
    assert np.all(np.diff(kept) > 0)
    assert kept.size <= columns * rows
    assert (kept.size > 0) == (points[0].size > 0)


@given(COORDINATES)
def test_every_point_is_near_one_that_is_kept(points: tuple[np.ndarray, np.ndarray]) -> None:
    # Halves, since differences of the largest floats overflow.
    x, y = points[0] / 2, points[1] / 2
    kept = one_per_cell(*points, 8, 8)
    if not x.size:
        return
    reach = [max((values.max() - values.min()) / 8 * (1 + 1e-9), 0.0) for values in (x, y)]
    near = (np.abs(x[:, None] - x[kept]) <= reach[0]) & (np.abs(y[:, None] - y[kept]) <= reach[1])
    assert near.any(axis=1).all()


def test_thinning_what_is_thin_changes_nothing() -> None:
    rng = np.random.default_rng(3)
    x, y = rng.normal(size=(2, 5000))
    kept = one_per_cell(x, y, 20, 20)
    grid = {
        (int(a), int(b))
        for a, b in zip(
            *(np.digitize(v, np.linspace(v.min(), v.max(), 21)[1:-1]) for v in (x, y)), strict=True
        )
    }
    assert kept.size == len(grid)
