import xml.etree.ElementTree as ET
from pathlib import Path

import pytest

pytest.importorskip("sklearn", reason="the peers are not installed (extra [bench])")
pytest.importorskip("skimage", reason="the peers are not installed (extra [bench])")
pytest.importorskip("statsmodels", reason="the peers are not installed (extra [bench])")

from benchmarks.__main__ import main
from benchmarks.report import table


def test_a_quick_run_writes_the_page_with_every_contender_and_the_picture(tmp_path: Path) -> None:
    assert main(["--quick", "--jobs", "1", "--out", str(tmp_path)]) == 0
    page = (tmp_path / "benchmarks.md").read_text()
    for name in ("Plumbline auto", "Plumbline msac", "scikit-image ransac", "scipy siegelslopes"):
        assert page.count(f"{name}") >= 3
    assert "$" not in page
    picture = ET.parse(tmp_path / "images" / "benchmark_failures.svg").getroot()
    assert picture.tag.endswith("svg")


def test_a_table_is_markdown_with_numbers_to_the_right() -> None:
    assert table(["a", "b"], [["x", "1"]]) == "| a | b |\n| --- | ---: |\n| x | 1 |"
