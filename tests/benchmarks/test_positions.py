"""The bed of positions: what it draws, how answers are judged, and the page."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from benchmarks.positions import rtklib
from benchmarks.positions.answers import Answer, horizontal_error, judge
from benchmarks.positions.cells import measure_bed, measure_protection, simulated_bed
from benchmarks.positions.clean import (
    AUTO,
    RTKLIB_AS_IS,
    RTKLIB_ONE_MESSAGE,
    CleanCell,
    measure_clean,
)
from benchmarks.positions.faults import SIZES, inject
from benchmarks.positions.ours import answer_by_auto, answer_by_method
from benchmarks.positions.page import describe_versions, write_page
from benchmarks.positions.peers import answer_by_peer, peer_version
from benchmarks.positions.sky import OPEN_SKIES, STATIONS, Station, read_station, simulate_sky
from estimators.geodesy.ellipsoid import to_geodetic
from estimators.geodesy.local_frame import enu_axes
from tests.external import require_program


@pytest.mark.parametrize("size", SIZES)
def test_so_many_satellites_lie_as_are_asked_for(size: str) -> None:
    rng = np.random.default_rng(1)
    given = inject(simulate_sky(rng, 45.0, 0.3), 3, size, rng)
    assert int(given.faulty.sum()) == 3
    length = np.abs(given.bias_m[given.faulty])
    if size.isdigit():
        np.testing.assert_array_equal(length, float(size))
    if size == "20-2000":
        assert np.all((length >= 20.0) & (length <= 2000.0))


def test_colluding_satellites_agree_on_one_false_position() -> None:
    rng = np.random.default_rng(2)
    sky = simulate_sky(rng, 45.0, 0.0)
    given = inject(sky, len(sky.name), "colluding", rng)
    (answer,), _ = answer_by_auto([given])
    assert answer.position_m is not None
    assert answer.used.all()
    assert 90.0 < horizontal_error(answer.position_m, sky.truth_m) < 1010.0


@pytest.mark.parametrize("latitude", [0.0, 45.0, 80.0])
def test_a_simulated_sky_is_above_the_mask_and_has_the_noise_asked_for(latitude: float) -> None:
    rng = np.random.default_rng(3)
    ratio = []
    for _ in range(60):
        sky = simulate_sky(rng, latitude, 0.5)
        up = (sky.satellites_m - sky.truth_m) @ enu_axes(*to_geodetic(sky.truth_m)[:2])[2]
        assert np.all(up > 0.0)
        left = sky.ranges_m - np.linalg.norm(sky.satellites_m - sky.truth_m, axis=1)
        ratio.append(np.var((left - left.mean()) / sky.sigma_m, ddof=1))
    assert np.sqrt(np.mean(ratio)) == pytest.approx(0.5, abs=0.06)


def test_answers_are_judged_by_what_they_use_how_far_they_are_off_and_whether_they_say_so() -> None:
    rng = np.random.default_rng(4)
    given = inject(simulate_sky(rng, 45.0, 0.3), 1, "1000", rng)
    truth, all_used = given.sky.truth_m, np.ones(len(given.sky.name), dtype=np.bool_)
    far = truth + 500.0 * np.array([0.0, 0.0, 1.0])
    answers = [
        Answer(truth, ~given.faulty, hpl_m=5.0),
        Answer(truth, all_used),
        Answer(far, all_used, hpl_m=5.0),
        Answer(far, all_used, flagged=True),
        Answer(None, all_used),
    ]
    score = judge([given] * 5, answers)
    assert (score.strict, score.right, score.lies) == (20.0, 40.0, 20.0)
    assert (score.forced_strict, score.forced) == (20.0, 40.0)
    assert (score.flagged, score.none, score.healthy_excluded) == (20.0, 20.0, 0.0)
    assert (score.hpl_m, score.hpl_misses) == (5.0, 50.0)


def test_the_batch_and_the_verb_give_the_same_positions() -> None:
    rng = np.random.default_rng(5)
    faulty = [inject(simulate_sky(rng, 50.0, 0.4), 2, "100", rng) for _ in range(10)]
    for one, other in zip(answer_by_auto(faulty)[0], answer_by_method("auto", faulty)[0], strict=True):
        assert one.position_m is not None
        assert other.position_m is not None
        np.testing.assert_allclose(one.position_m, other.position_m, atol=1e-6)
        assert one.flagged == other.flagged


def test_faults_in_a_file_are_what_rtklib_sees(gnss_data: Path) -> None:
    require_program(rtklib.PROGRAM)
    station = STATIONS[0]
    skies = read_station(station, gnss_data)[:20]
    rng = np.random.default_rng(6)
    clean = judge_all(station, gnss_data, [inject(sky, 0, "50", rng) for sky in skies])
    faulty = judge_all(station, gnss_data, [inject(sky, 1, "1000", rng) for sky in skies])
    assert clean == (100.0, 0.0)
    assert faulty[0] >= 90.0
    assert faulty[1] > 5.0


@pytest.mark.parametrize("station", OPEN_SKIES[:2] + OPEN_SKIES[3:5], ids=lambda station: station.title)
def test_positions_of_whole_files_are_not_worse_than_rtklibs(station: Station, gnss_data: Path) -> None:
    require_program(rtklib.PROGRAM)
    cells = {cell.contender: cell for cell in measure_clean([station], gnss_data, lambda _: None)}
    ours = cells[AUTO]
    assert ours.epochs >= 700
    for theirs in (RTKLIB_AS_IS, RTKLIB_ONE_MESSAGE):
        if theirs in cells:
            for our, their in zip(ours.horizontal_m, cells[theirs].horizontal_m, strict=True):
                assert our < their + 0.02


def test_rtklib_loses_group_delays_where_galileos_messages_are_mixed(gnss_data: Path) -> None:
    require_program(rtklib.PROGRAM)
    esbc = OPEN_SKIES[1]
    mixed, inav = (rtklib.clean_positions(esbc, gnss_data, one_message=alone) for alone in (False, True))
    errors = [
        [horizontal_error(found[at], np.array(esbc.truth_m)) for at in sorted(found)]
        for found in (mixed, inav)
    ]
    assert len(mixed) == len(inav) == 720
    assert np.quantile(errors[0], 0.95) > 1.2 * np.quantile(errors[1], 0.95)


def judge_all(station: object, data: Path, faulty: list[object]) -> tuple[float, float]:
    """Percent right, and percent of all satellites that were left out."""
    answers, ms = rtklib.answer_by_rtklib(station, data, faulty)  # type: ignore[arg-type]
    assert ms > 0.0
    used = np.concatenate([answer.used for answer in answers])
    return judge(faulty, answers).right, 100.0 * float(np.mean(~used))  # type: ignore[arg-type]


@pytest.mark.parametrize("peer", ["sidereon", "gnss_lib_py"])
def test_a_peer_answers_clean_epochs_rightly(peer: str, gnss_data: Path) -> None:
    if peer_version(peer) is None:
        pytest.skip(f"{peer} is not in the peers' environment")
    skies = read_station(STATIONS[0], gnss_data)[:8]
    rng = np.random.default_rng(7)
    faulty = [inject(sky, 0, "50", rng) for sky in skies]
    answers, _ = answer_by_peer(peer, STATIONS[0], gnss_data, skies, faulty)
    score = judge(faulty, answers)
    assert (score.right, score.healthy_excluded) == (100.0, 0.0)
    assert score.error_m < 10.0


def test_an_absent_peer_is_said_to_be_absent() -> None:
    assert peer_version("no_such_peer_of_ours") is None
    said = describe_versions(rtklib=False, sidereon=None, gnss_lib_py="1.0")
    assert [text.endswith("absent") for text in said] == [True, True, False]


def test_what_was_measured_becomes_a_page(tmp_path: Path) -> None:
    bed = simulated_bed(0.3, 4, 1, ("auto", "ols"))
    said: list[str] = []
    cells = measure_bed(bed, 1, said.append)
    assert len(cells) == len(said) == 2 * (1 + 4 * len(SIZES))
    clean = [CleanCell("a file", AUTO, 7, (0.1, 0.2), (0.3, 0.4), (0.5, 0.6))]
    page = write_page(cells, clean, measure_protection(5, 1, said.append), ["nobody"], tmp_path).read_text()
    assert "| a file | 7 | auto | 0.10 / 0.20 | 0.30 / 0.40 | 0.50 / 0.60 |" in page
    assert page.count("\n| 3 of ") == len(SIZES)
    assert "| ols |" in page
    assert "nobody" in page
    assert page.count("| simulated GPS, noise x") == 9
