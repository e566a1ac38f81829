"""Live tracks: final answers after a bounded delay, however the rows are cut into calls."""

import doctest
import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from estimators import InputError, TrackOptions, clean_live
from estimators.trajectories.live import clean_live as verb
from tests.trajectories.drives import MUNICH, drive, with_bursts, with_spikes
from tests.trajectories.live.streams import Columns, bytes_of, columns, disordered

FAULTY = with_bursts(with_spikes(drive(3, n=330)), length=15)
SENT = columns(FAULTY)
EMPTY: list[float] = []


def test_the_example_is_true() -> None:
    found = doctest.testmod(verb, extraglobs={"np": np})
    assert found.attempted > 0
    assert found.failed == 0


@given(st.lists(st.integers(0, 150), max_size=12), st.integers(0, 3))
@settings(max_examples=15, deadline=None)
def test_settled_rows_are_the_same_bytes_however_they_are_cut(cuts: list[int], seed: int) -> None:
    sent = disordered(with_spikes(drive(seed, n=147)), seed)
    whole, state = sent.send_in([])
    cut, cut_state = sent.send_in([min(place, sent.t.size) for place in cuts])
    assert bytes_of(whole) == bytes_of(cut)
    assert state == cut_state


def test_fixes_that_come_one_by_one_are_settled_like_a_whole_file() -> None:
    whole, state = SENT.send_in([])
    single, single_state = SENT.send_in(list(range(1, SENT.t.size)))
    assert bytes_of(whole) == bytes_of(single)
    assert state == single_state


def test_every_row_is_settled_once() -> None:
    sent = disordered(drive(1, n=200), 1)
    settled, _ = sent.send_in([40, 90])
    assert sorted(settled.row.tolist()) == list(range(sent.t.size))


@pytest.mark.parametrize("lag", [4, 32, 128])
def test_no_more_rows_than_the_lag_are_provisional(lag: int) -> None:
    answer = SENT.send(0, 0, lag=lag)
    for first in range(0, 330, 10):
        answer = SENT.send(first, first + 10, answer.state)
        assert len(answer.provisional) <= lag
    assert len(answer.provisional) > lag // 2


def test_provisional_rows_are_the_open_ones_in_order_of_time() -> None:
    answer = SENT.send(0, 100)
    settled = answer.settled.row.tolist()
    assert settled + answer.provisional.row.tolist() == list(range(100))
    np.testing.assert_array_equal(answer.provisional.time, SENT.t[len(settled) : 100])


def test_a_live_track_comes_near_the_answer_for_the_whole() -> None:
    settled, _ = SENT.send_in([])
    offline = FAULTY.clean()
    hits = np.count_nonzero(~settled.inlier & FAULTY.faulty[settled.row])
    assert 2.0 * hits / (np.count_nonzero(~settled.inlier) + np.count_nonzero(FAULTY.faulty)) > 0.95
    found = MUNICH.project(settled.lat_deg, settled.lon_deg) - FAULTY.truth[settled.row]
    assert np.sqrt(np.mean(np.sum(found**2, axis=1))) < 1.4 * FAULTY.error(offline)


def test_a_burst_longer_than_the_lag_stays_a_burst() -> None:
    made = with_bursts(drive(5, n=300), length=20)
    answer = columns(made).send(0, 300, lag=12, finish=True)
    found = ~answer.settled.inlier[np.argsort(answer.settled.row)]
    assert np.count_nonzero(found & made.faulty) > 0.95 * np.count_nonzero(made.faulty)
    assert np.count_nonzero(found & ~made.faulty) <= 2


def test_a_motion_that_becomes_livelier_is_no_fault() -> None:
    t = np.arange(500.0)
    speed = np.where(t < 250.0, 1.3, np.minimum(30.0, 1.3 + 2.0 * (t - 250.0)))
    rng = np.random.default_rng(0)
    fixes = np.column_stack([np.cumsum(speed), 0.0 * t]) + rng.normal(0.0, 3.0, (500, 2))
    settled, _ = Columns(t, *MUNICH.locate(fixes)).send_in([])
    assert np.count_nonzero(~settled.inlier) <= 2


def test_rows_within_the_lag_are_sorted_in() -> None:
    rows = np.arange(120)
    rows[[60, 70]] = rows[[70, 60]]
    mixed = Columns(SENT.t[rows], SENT.lat[rows], SENT.lon[rows])
    settled, _ = mixed.send_in([])
    assert "out_of_order" not in settled.reason
    assert np.all(np.diff(settled.time) > 0.0)


def test_a_row_before_the_settled_ones_is_out_of_order() -> None:
    first = SENT.send(0, 100)
    late = clean_live([20.5], SENT.lat[20:21], SENT.lon[20:21], state=first.state)
    assert late.settled.reason == ["out_of_order"]
    assert not late.settled.inlier[0]


def test_a_row_that_is_sent_again_is_a_duplicate() -> None:
    first = SENT.send(0, 100)
    again = SENT.send(20, 50, first.state)
    assert set(again.settled.reason) == {"duplicate"}
    assert len(SENT.send(100, 101, again.state).provisional) > 0


def test_a_clock_that_was_set_back_begins_the_track_anew() -> None:
    first = SENT.send(0, 100)
    back = clean_live(SENT.t[100:150] - 500.0, SENT.lat[100:150], SENT.lon[100:150], state=first.state)
    assert back.settled.reason.count("out_of_order") == 7
    rest = clean_live(EMPTY, EMPTY, EMPTY, state=back.state, finish=True)
    assert rest.settled.time[-1] == SENT.t[149] - 500.0
    assert np.isfinite(rest.settled.lat_deg).all()


def test_a_first_call_with_one_fix_answers_it() -> None:
    answer = clean_live([5.0], [48.0], [11.0])
    assert len(answer.settled) == 0
    assert answer.provisional.lat_deg == pytest.approx([48.0])


def test_a_call_without_rows_leaves_the_state() -> None:
    first = SENT.send(0, 50)
    again = clean_live(EMPTY, EMPTY, EMPTY, state=first.state)
    assert again.state == first.state
    assert len(again.settled) == 0
    assert bytes_of(again.provisional) == bytes_of(first.provisional)


def test_nothing_at_all_is_a_track_of_no_rows() -> None:
    answer = clean_live(EMPTY, EMPTY, EMPTY, finish=True)
    assert len(answer.settled) == len(answer.provisional) == 0


@pytest.mark.parametrize(
    ("t", "lat"),
    [
        (np.zeros(60), 48.0 + 1e-5 * np.arange(60)),
        (np.arange(60.0), np.full(60, np.nan)),
        (np.full(60, np.nan), np.full(60, 48.0)),
        (np.arange(60.0), np.full(60, 48.0)),
        (np.cumsum(np.where(np.arange(60) % 20 == 0, 9000.0, 1.0)), 48.0 + 1e-5 * np.arange(60)),
        (np.where(np.arange(60) == 7, 1e20, np.arange(60.0)), 48.0 + 1e-5 * np.arange(60)),
    ],
    ids=["one time", "no place", "no time", "stands", "gaps of hours", "far future"],
)
def test_poor_rows_are_answered_one_for_one_without_nan_on_the_wire(t: np.ndarray, lat: np.ndarray) -> None:
    settled, _ = Columns(t, lat, np.full(60, 11.0)).send_in([1, 30])
    assert sorted(settled.row.tolist()) == list(range(60))
    json.dumps(settled.to_dict(), allow_nan=False)


def test_points_in_time_and_seconds_give_one_answer() -> None:
    moments = np.datetime64("2025-03-30T00:59:00", "ns") + (SENT.t * 1e9).astype("timedelta64[ns]")
    first = clean_live(moments[:150], SENT.lat[:150], SENT.lon[:150])
    second = SENT.send(0, 150)
    np.testing.assert_array_equal(first.settled.lat_deg, second.settled.lat_deg)
    np.testing.assert_array_equal(first.settled.time, moments[: len(first.settled)])


def test_the_antimeridian_is_a_place_like_any_other() -> None:
    here, _ = SENT.send_in([])
    there, _ = Columns(SENT.t, SENT.lat, (SENT.lon - 11.5 + 180.0 + 180.0) % 360.0 - 180.0).send_in([])
    np.testing.assert_array_equal(here.reason_codes, there.reason_codes)
    np.testing.assert_allclose(here.lat_deg, there.lat_deg, atol=1e-8)


def test_a_given_noise_is_kept() -> None:
    answer = SENT.send(0, 200, options=TrackOptions(sigma_m=7.0))
    assert answer.noise.sigma_m == pytest.approx(7.0)
    assert answer.noise.source == "given"


def test_heights_are_smoothed_along() -> None:
    heights = 500.0 + 0.5 * SENT.t + np.random.default_rng(0).normal(0.0, 4.0, SENT.t.size)
    settled, _ = Columns(SENT.t, SENT.lat, SENT.lon, height=heights).send_in([])
    error = settled.height_m - (500.0 + 0.5 * SENT.t[settled.row])
    assert np.sqrt(np.mean(error**2)) < 2.5


@pytest.mark.parametrize("lag", [3, 129, 8.0, True])
def test_a_lag_out_of_range_is_refused(lag: object) -> None:
    with pytest.raises(InputError, match="lag"):
        clean_live([0.0], [48.0], [11.0], lag=lag)  # type: ignore[arg-type]


def test_another_lag_than_the_tracks_is_refused() -> None:
    state = SENT.send(0, 10, lag=16).state
    with pytest.raises(InputError, match="began with 16"):
        SENT.send(10, 20, state, lag=32)
    assert len(SENT.send(10, 20, state).provisional) > 0


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (TrackOptions(), r"options\.max_speed_mps: the track began with 40"),
        (TrackOptions(sigma_m=3.0, max_speed_mps=40.0), r"options\.sigma_m: the track began without one"),
    ],
)
def test_other_options_than_the_tracks_are_refused(options: TrackOptions, message: str) -> None:
    state = SENT.send(0, 10, options=TrackOptions(max_speed_mps=40.0)).state
    with pytest.raises(InputError, match=message):
        SENT.send(10, 20, state, options=options)


def test_another_kind_of_times_is_refused() -> None:
    state = SENT.send(0, 10).state
    with pytest.raises(InputError, match="numbers of seconds"):
        clean_live(["2025-01-01T00:00:00Z"], [48.0], [11.0], state=state)


def test_columns_of_different_length_are_refused() -> None:
    with pytest.raises(InputError, match="lon_deg"):
        clean_live([0.0, 1.0], [48.0, 48.0], [11.0])
