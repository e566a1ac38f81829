"""The measurement of coverage, p-values and calibration."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.coverage import PAGE, Noise, calibration_error, correlated_noise, draw_noise, write_tables


def test_correlation_fades_with_the_time_between_readings() -> None:
    t = np.cumsum(np.tile([1.0, 3.0], 20_000))
    noise = correlated_noise(t, 0.8, np.random.default_rng(0))
    near = np.corrcoef(noise[1::2], noise[:-1:2])[0, 1]
    far = np.corrcoef(noise[2::2], noise[1:-1:2])[0, 1]
    assert sorted((near, far)) == pytest.approx([0.8**3, 0.8], abs=0.02)


def test_a_draw_depends_on_its_cell_and_index_alone() -> None:
    cell = Noise(80, 0.5, 0.2, "irregular")
    np.testing.assert_array_equal(draw_noise(cell, 7, 1), draw_noise(cell, 7, 1))
    assert (draw_noise(cell, 7, 1)[1] != draw_noise(cell, 8, 1)[1]).any()


def test_true_probabilities_have_no_calibration_error_and_overconfident_ones_theirs() -> None:
    stated = np.repeat([0.1, 0.5, 0.9], 1000)
    truth = np.concatenate([np.arange(1000) < count for count in (100, 500, 900)])
    assert calibration_error(stated, truth) == 0.0
    assert calibration_error(np.ones(1000), np.arange(1000) < 800) == pytest.approx(0.2)


def test_tables_are_written_where_the_page_has_a_place_for_them() -> None:
    page = "before\n<!-- measured: coverage -->\nold\n<!-- end of measured -->\nafter"
    written = write_tables(page, {"coverage": "| new |"})
    assert written == "before\n<!-- measured: coverage -->\n\n| new |\n\n<!-- end of measured -->\nafter"
    assert write_tables(written, {"coverage": "| new |"}) == written
    with pytest.raises(ValueError, match="no place for the table p-values"):
        write_tables(page, {"p-values": ""})


def test_the_page_has_every_measured_table() -> None:
    text = PAGE.read_text()
    for name in ("coverage", "p-values", "calibration"):
        table = text.split(f"<!-- measured: {name} -->")[1].split("<!-- end of measured -->")[0]
        assert table.count("\n| ") >= 10
