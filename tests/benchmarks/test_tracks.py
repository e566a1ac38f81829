"""The bench of tracks: how answers are judged, peers, recorded drives, and the page."""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from benchmarks.tracks.figure import save_errors
from benchmarks.tracks.generator import record
from benchmarks.tracks.goals import goals_table
from benchmarks.tracks.maps import LOOKED_AT, save_maps
from benchmarks.tracks.measure import leave_raw, measure_drives, measure_scenarios, pool
from benchmarks.tracks.page import OURS, RAW, Measured, write_page
from benchmarks.tracks.peers import PEERS, Peer, answer_by_peer, find_peer
from benchmarks.tracks.real import DRIVES, present_drives, read_drive
from benchmarks.tracks.recording import FAULTY, Recording
from benchmarks.tracks.scenarios import SCENARIOS
from benchmarks.tracks.scores import Answer, Pool, judge

SPIKES, STANDING = SCENARIOS["city, spikes 20 %"], SCENARIOS["stationary, clean"]


def _truth(recordings: Sequence[Recording]) -> list[tuple[Answer, float] | None]:
    """Answer with the truth, sure of a metre."""
    return [
        (
            Answer(
                one.true_lat_deg,
                one.true_lon_deg,
                one.label == FAULTY,
                np.tile(np.eye(2), (len(one), 1, 1)),
            ),
            0.5,
        )
        for one in recordings
    ]


def _nothing(recordings: Sequence[Recording]) -> list[tuple[Answer, float] | None]:
    return [None for _ in recordings]


def _all_flagged(recordings: Sequence[Recording]) -> list[tuple[Answer, float] | None]:
    return [(Answer(one.lat_deg, one.lon_deg, np.ones(len(one), dtype=np.bool_)), 1.0) for one in recordings]


def test_the_truth_has_the_best_scores() -> None:
    recording = record(SPIKES, 1)
    ((answer, seconds),) = [found for found in _truth([recording]) if found is not None]
    score = judge(recording, answer, 2.0, seconds)
    assert (score.hits, score.misses, score.alarms, score.good) == (180, 0, 0, 720)
    assert score.rmse_m == pytest.approx(0.0, abs=1e-6)
    assert score.distance_error == pytest.approx(0.0, abs=1e-9)
    assert (score.covered, score.regions) == (900, 900)
    assert Pool([score]).f1 == Pool([score]).precision == Pool([score]).recall == 1.0
    assert Pool([score]).points_per_second == 1800.0


def test_the_raw_track_is_as_good_as_the_raw_track() -> None:
    recording = record(SPIKES, 2)
    score = judge(recording, Answer(recording.lat_deg, recording.lon_deg), 2.0, 0.0)
    assert Pool([score]).over_raw == Pool([score]).worst_over_raw == pytest.approx(1.0)
    assert score.distance_error == score.raw_distance_error > 1.0
    assert np.isnan(Pool([score]).f1)


def test_flags_that_miss_and_flags_that_cry_wolf_cost_recall_and_precision() -> None:
    recording = record(SPIKES, 3)
    faulty = np.flatnonzero(recording.label == FAULTY)
    good = np.flatnonzero(~recording.faulty)
    flagged = np.zeros(len(recording), dtype=np.bool_)
    flagged[faulty[:90]] = True
    flagged[good[:30]] = True
    own = Pool([judge(recording, Answer(recording.lat_deg, recording.lon_deg, flagged), 2.0, 0.0)])
    assert own.recall == 0.5
    assert own.precision == 0.75
    assert own.f1 == pytest.approx(0.6)
    assert own.alarm_percent == pytest.approx(100.0 * 30 / 720)


def test_regions_of_the_true_spread_hold_the_truth_as_often_as_they_say() -> None:
    recording = record(replace(STANDING, duration_s=20000.0), 4)
    covariance = 16.0 * np.tile(np.eye(2), (len(recording), 1, 1))
    answer = Answer(recording.lat_deg, recording.lon_deg, None, covariance)
    assert Pool([judge(recording, answer, 1.0, 0.0)]).coverage_percent == pytest.approx(95.0, abs=1.0)


def test_a_receiver_that_stands_has_a_drift_and_no_relative_error_of_its_distance() -> None:
    recording = record(STANDING, 5)
    score = judge(recording, Answer(recording.lat_deg, recording.lon_deg, None, None, 10.0), 1.0, 0.0)
    assert score.drift_m_per_h == pytest.approx(10.0 / (1799.0 / 3600.0))
    assert np.isnan(score.distance_error)


def test_an_unanswered_track_is_scored_as_raw_and_counted() -> None:
    (cell,) = measure_scenarios([SPIKES], {OURS: _nothing}, {}, 2, 1, lambda _: None)
    assert cell.unanswered == 2
    assert pool([cell], split="tune").over_raw == pytest.approx(1.0)


def test_an_absent_peer_is_not_found() -> None:
    assert find_peer(Peer("nobody", ("no_such_cleaner_of_ours",), "no-such-cleaner")) is None


@pytest.mark.parametrize("title", list(PEERS))
def test_a_peer_answers_a_track_with_spikes(title: str) -> None:
    found = find_peer(PEERS[title])
    if found is None:
        pytest.skip(f"{title} is not in the peers' environments")
    recording = record(SPIKES, 6)
    (answered,) = answer_by_peer(found[0], PEERS[title], [recording])
    assert answered is not None
    score = judge(recording, *[answered[0], 2.0, answered[1]])
    assert score.seconds > 0.0
    assert np.isfinite(score.rmse_m)
    assert score.rmse_m <= score.raw_m


def test_a_recorded_drive_has_a_truth_and_no_labels() -> None:
    beside = Path(__file__).resolve().parents[3] / "shared" / "data"
    folder = Path(os.environ.get("PLUMBLINE_TEST_DATA", beside)) / "trajectories" / "real"
    if not folder.is_dir():
        pytest.skip("the recorded drives are not here; PLUMBLINE_TEST_DATA says where they are")
    drives = present_drives(folder)
    assert [drive.name for drive in drives] == list(DRIVES)
    for drive in drives:
        raw = drive.error_m(drive.lat_deg, drive.lon_deg)
        assert np.isfinite(raw).all(axis=1).mean() > 0.5
        assert not drive.faulty.any()


def test_absent_drives_are_left_out(tmp_path: Path) -> None:
    assert present_drives(tmp_path) == []


def _write_drive(folder: Path) -> Path:
    rows = [f"{k},48.00001,{11 + 1e-5 * k:.6f},48.0,{11 + 1e-5 * k:.6f}" for k in range(20)]
    rows[3] = "3,48.001,11.00003,,"
    path = folder / f"{DRIVES[0]}.csv"
    path.write_text("\n".join(["t,lat,lon,lat_true,lon_true", *rows]) + "\n", encoding="utf-8")
    return path


def test_a_row_without_a_truth_is_not_scored(tmp_path: Path) -> None:
    drive = read_drive(_write_drive(tmp_path))
    assert np.isnan(drive.true_lat_deg[3])
    score = judge(drive, Answer(drive.lat_deg, drive.lon_deg), float("nan"), 0.0)
    assert score.raw_m == pytest.approx(1.11, abs=0.01)


def test_what_was_measured_becomes_a_page_with_pictures(tmp_path: Path) -> None:
    said: list[str] = []
    cells = measure_scenarios([SPIKES, STANDING], {OURS: _truth}, {RAW: leave_raw}, 2, 1, said.append)
    _write_drive(tmp_path)
    contenders = {OURS: _truth, RAW: leave_raw}
    drives = measure_drives(present_drives(tmp_path), contenders, said.append)
    assert len(cells) + len(drives) == 6
    assert len(said) == 4
    page = write_page(Measured(cells, drives, 2, 1, ["somebody: absent"]), tmp_path).read_text()
    assert "| spikes, tune | 1 | 1.000 |" in page
    assert "| clean, held out | 1 |" in page
    assert "somebody: absent" in page
    assert "nan" not in page
    assert "| F1, spikes | at least 0.97 | 1.000 |  |" in page
    assert "| good rows flagged, clean, % | at most 0.1 |  | 0.000 |" in page
    assert re.search(r"\| stationary, clean \| 0\.0 \|", page)
    assert f"| {DRIVES[0]} | 20 | 0.0 | 1.1 |" in page
    save_errors(cells, tmp_path / "errors.svg")
    save_errors(cells, tmp_path / "again.svg")
    assert (tmp_path / "errors.svg").read_bytes() == (tmp_path / "again.svg").read_bytes()


def test_a_goal_that_is_missed_is_bold() -> None:
    cells = measure_scenarios([SPIKES], {OURS: _all_flagged}, {}, 1, 1, lambda _: None)
    told = goals_table(cells, [])
    assert "| F1, spikes | at least 0.97 | **0.333** |  |" in told
    assert "| RMSE over raw, worst track | at most 1.05 | 1.00 |  |" in told


def test_without_drives_the_page_says_that_they_are_left_out(tmp_path: Path) -> None:
    cells = measure_scenarios([SPIKES], {OURS: _truth}, {}, 1, 1, lambda _: None)
    assert "left out" in write_page(Measured(cells, [], 1, 1, []), tmp_path).read_text()


def test_maps_are_drawn_of_types_that_exist(tmp_path: Path) -> None:
    assert len(LOOKED_AT) == 10
    assert set(LOOKED_AT) <= set(SCENARIOS)
    recording = record(SCENARIOS[LOOKED_AT[3]], 1)
    ((answer, _),) = [found for found in _truth([recording]) if found is not None]
    save_maps([(recording, answer)], tmp_path / "map.png")
    assert (tmp_path / "map.png").read_bytes().startswith(b"\x89PNG")
