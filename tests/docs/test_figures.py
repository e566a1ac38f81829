from pathlib import Path

import numpy as np

from examples import disk_usage, figures, pseudoranges
from tests.docs.comparison import difference


def test_the_example_data_are_what_their_script_makes() -> None:
    assert disk_usage.FILE.read_text() == disk_usage.to_csv(disk_usage.simulate())
    assert pseudoranges.FILE.read_text() == pseudoranges.to_csv(pseudoranges.simulate()[0])


def test_the_trend_in_the_example_covers_the_growth_that_was_simulated() -> None:
    slope = figures.fit_disk().parameters["slope"]
    assert slope.low is not None
    assert slope.high is not None
    assert slope.low * 86_400 <= disk_usage.GROWTH_GB_PER_DAY <= slope.high * 86_400


def test_the_position_in_the_example_is_where_the_receiver_was_put() -> None:
    fix = figures.locate_receiver()
    off = np.linalg.norm(fix.position_ecef_m - pseudoranges.truth_m())
    assert off < fix.hpl_m
    assert not fix.ambiguous


def test_every_committed_picture_is_one_that_the_script_draws() -> None:
    committed = {path.name for path in figures.IMAGES.iterdir() if not path.name.startswith("benchmark")}
    drawn = {
        f"{name}{theme}.svg"
        for name in ("disk_usage", "carbon_dioxide", "sky", "ride")
        for theme in figures.THEMES
    }
    assert committed == drawn


def test_the_committed_pictures_are_what_the_code_draws_today(tmp_path: Path) -> None:
    for drawn in figures.draw(tmp_path):
        found = difference((figures.IMAGES / drawn.name).read_text(), drawn.read_text())
        assert found is None, f"{drawn.name}: {found}; `make figures` draws it again"


def test_the_pictures_are_light_enough_for_a_page() -> None:
    heavy = [path.name for path in figures.IMAGES.iterdir() if path.stat().st_size > 150_000]
    assert heavy == []
