"""Plumbline on the bed of tracks, through the command."""

from __future__ import annotations

from pathlib import Path

import pytest

from benchmarks.tracks.generator import record
from benchmarks.tracks.scenarios import SCENARIOS
from benchmarks.tracks.scores import judge


def test_auto_betters_a_track_with_spikes() -> None:
    from benchmarks.tracks.ours import answer_by

    recording = record(SCENARIOS["city, spikes 5 %"], 1)
    answer, seconds = answer_by("auto", recording)
    score = judge(recording, answer, 1.0, seconds)
    assert score.rmse_m < 0.2 * score.raw_m
    assert score.hits > 0.8 * (score.hits + score.misses)
    assert score.regions == len(recording)


def test_the_command_writes_the_page_and_its_pictures(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from benchmarks.tracks.__main__ import main

    monkeypatch.setenv("PLUMBLINE_TEST_DATA", str(tmp_path))
    monkeypatch.setenv("PLUMBLINE_TRACK_PEERS_PYTHON", "/bin/false")
    assert main(["--seeds", "1", "--other-seeds", "1", "--only", "sparse", "--out", str(tmp_path)]) == 0
    page = (tmp_path / "benchmarks_tracks.md").read_text(encoding="utf-8")
    assert page.count("absent") == 6
    assert "| Plumbline auto |" in page
    assert (tmp_path / "images" / "benchmark_tracks.svg").is_file()
    assert (tmp_path / "images" / "benchmark_tracks_maps.png").is_file()


def test_a_type_that_nobody_knows_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    from benchmarks.tracks.__main__ import main

    with pytest.raises(SystemExit):
        main(["--only", "no such track"])
    assert "no type of track" in capsys.readouterr().err
