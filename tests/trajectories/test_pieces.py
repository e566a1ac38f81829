"""A track cleaned piece by piece is the track cleaned as a whole."""

from __future__ import annotations

import itertools
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from estimators import InputError, NoFit, Track, clean_in_pieces, clean_trajectory
from estimators.trajectories import course, measured_rows, projected, solve
from estimators.trajectories.course import Course
from estimators.trajectories.estimation import Measured, label
from estimators.trajectories.labelling import reconcile
from estimators.trajectories.labelling.modes import BURST, ENTRY, EXIT, NOMINAL
from estimators.trajectories.labelling.passage import Passage
from estimators.trajectories.labelling.reconcile import doubtful
from estimators.trajectories.measured_rows import MeasuredRows
from estimators.trajectories.methods import whole_track
from estimators.trajectories.parameters import TrackParameters
from estimators.trajectories.pieces import TrackPieces
from estimators.trajectories.projected import Projected
from tests.trajectories.drives import MUNICH, Drive, drive, with_bursts, with_spikes

MADE = with_bursts(with_spikes(drive(8, n=900), share=0.05))
COLUMNS = ("lat_deg", "lon_deg", "height_m", "variance_m2", "variance_up_m2", "speed_mps", "speed_sigma_mps",
           "heading_deg", "heading_sigma_deg")  # fmt: skip


def hostile() -> dict[str, np.ndarray]:
    """Rows in disorder, without time or place, twice, repeated, with a gap, heights and accuracies."""
    rng = np.random.default_rng(5)
    lat, lon = MUNICH.locate(MADE.fixes)
    t, height = MADE.t.copy(), 500.0 + rng.normal(size=MADE.t.size)
    t[600:] += 900.0
    lat[300:340], lon[300:340] = lat[300], lon[300]
    lat[20], t[40], height[100:180] = np.nan, np.nan, np.nan
    rows = np.concatenate([np.arange(t.size), [70, 70, 500]])
    rows[[10, 11]] = rows[[11, 10]]
    accuracy = rng.uniform(3.0, 9.0, t.size)
    named = {"t_s": t, "lat_deg": lat, "lon_deg": lon, "height_m": height, "accuracy_m": accuracy}
    return {name: column[rows] for name, column in named.items()}


def jumping() -> dict[str, np.ndarray]:
    lat, lon = MUNICH.locate(MADE.fixes)
    t = MADE.t.copy()
    t[500:560] -= 400.0
    return {"t_s": t, "lat_deg": lat, "lon_deg": lon}


def restless() -> dict[str, np.ndarray]:
    """So many bursts that they are noise."""
    rng = np.random.default_rng(1)
    shift = np.repeat(60.0 * rng.normal(size=(90, 2)), 10, axis=0)
    shift[np.repeat(np.arange(90) % 2 == 0, 10)] = 0.0
    lat, lon = MUNICH.locate(MADE.truth + shift + rng.normal(size=shift.shape))
    return {"t_s": MADE.t, "lat_deg": lat, "lon_deg": lon}


def with_speeds() -> dict[str, np.ndarray]:
    """Speeds and courses that can be trusted, and a turn that is taken in a hurry."""
    rng = np.random.default_rng(3)
    fixes, velocity = MADE.fixes.copy(), np.gradient(MADE.truth, MADE.t, axis=0)
    velocity += 0.3 * rng.normal(size=velocity.shape)
    fixes[450:] += np.column_stack([12.0 * np.arange(450.0), np.zeros(450)])
    velocity[450:, 0] += 12.0
    lat, lon = MUNICH.locate(fixes)
    speed, bearing = np.hypot(*velocity.T), np.degrees(np.arctan2(*velocity.T))
    return {"t_s": MADE.t, "lat_deg": lat, "lon_deg": lon, "speed_mps": speed, "bearing_deg": bearing}


CASES = [hostile, jumping, restless, with_speeds]


def whole(columns: dict[str, np.ndarray]) -> Track:
    found = clean_trajectory(**columns)
    assert isinstance(found, Track)
    return found


def pieces(columns: dict[str, np.ndarray], rows: int) -> TrackPieces:
    found = clean_in_pieces(**columns, piece_rows=rows)
    assert not isinstance(found, NoFit)
    return found


@pytest.mark.parametrize("case", CASES)
@settings(max_examples=8, deadline=None)
@given(rows=st.integers(1, 1200))
def test_pieces_of_any_length_on_end_are_the_answer_of_the_whole(
    case: Callable[[], dict[str, np.ndarray]], rows: int
) -> None:
    track, found = whole(case()), pieces(case(), rows)
    seen = np.zeros(len(track), dtype=np.int64)
    for piece in found:
        assert len(piece) <= rows
        seen[piece.rows] += 1
        for name in COLUMNS:
            expected = getattr(track, name)
            if expected is None:
                assert getattr(piece, name) is None
            else:
                np.testing.assert_array_equal(getattr(piece, name), expected[piece.rows])
        np.testing.assert_array_equal(piece.points.inlier, track.points.inlier[piece.rows])
        np.testing.assert_array_equal(piece.points.probability, track.points.probability[piece.rows])
        np.testing.assert_array_equal(piece.points.residual_m, track.points.residual_m[piece.rows])
        np.testing.assert_array_equal(piece.points.reason_codes, track.points.reason_codes[piece.rows])
    assert np.all(seen == 1)
    facts = found.facts()
    assert (facts.distance, facts.stretches) == (track.distance, track.stretches)
    assert (facts.noise, facts.notices) == (track.noise, track.notices)
    assert facts.inliers == np.count_nonzero(track.points.inlier)


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("block", [1, 7, 100, 899])
def test_the_blocks_in_which_a_track_is_worked_on_do_not_show(
    case: Callable[[], dict[str, np.ndarray]], block: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    expected = whole(case())
    monkeypatch.setattr(solve, "Course", lambda rows, labelled: Course(rows, labelled, block))
    monkeypatch.setattr(whole_track, "_PIECE", max(block, 2))
    track = whole(case())
    np.testing.assert_array_equal(track.points.reason_codes, expected.points.reason_codes)
    np.testing.assert_array_equal(track.points.probability, expected.points.probability)
    for name in COLUMNS:
        found, wanted = getattr(track, name), getattr(expected, name)
        if wanted is not None:
            np.testing.assert_allclose(found, wanted, rtol=1e-9, atol=1e-10)
    assert track.distance.cleaned.value == pytest.approx(expected.distance.cleaned.value, rel=1e-12)
    assert [item.kind for item in track.stretches] == [item.kind for item in expected.stretches]
    assert [item.distance_m for item in track.stretches] == pytest.approx(
        [item.distance_m for item in expected.stretches], rel=1e-9
    )


@settings(max_examples=20, deadline=None)
@given(cuts=st.sets(st.integers(1, MADE.t.size - 1), max_size=12), lag=st.sampled_from([0, 1, 32]))
def test_a_beam_that_is_fed_piece_by_piece_labels_as_one_that_sees_all(cuts: set[int], lag: int) -> None:
    parameters = TrackParameters(4.0, 1.0, 1.0)
    every = Measured(MADE.t, np.ascontiguousarray(MADE.fixes), None)
    labels, probability, evidence = label(every, parameters, lag)
    passage = Passage(MADE.t.size, parameters, lag)
    edges = [0, *sorted(cuts), MADE.t.size]
    for first, stop in itertools.pairwise(edges):
        part = every.window(max(first - 1, 0), stop)
        passage.follow(
            part.t, part.fixes, part.variance(parameters), *part.velocities(), is_last=stop == MADE.t.size
        )
    np.testing.assert_array_equal(passage.labels, labels)
    assert passage.evidence == evidence
    if lag:
        np.testing.assert_array_equal(passage.probability, probability)


@settings(max_examples=50, deadline=None)
@given(data=st.data(), measures=st.lists(st.booleans(), min_size=1, max_size=60))
def test_a_window_of_what_measures_is_that_of_the_chosen_rows(
    data: st.DataObject, measures: list[bool]
) -> None:
    chosen = np.array(measures)
    t = np.arange(float(chosen.size))
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(measured_rows, "_STEP", 8)
        rows: MeasuredRows = measured_rows.measured_rows(t, Projected(MUNICH, t, t, chosen, None), chosen)
        first = data.draw(st.integers(0, rows.size))
        last = data.draw(st.integers(first, rows.size))
        window = rows.window(first, last)
        place = data.draw(st.integers(0, chosen.size))
        assert rows.before_row(place) == np.count_nonzero(chosen[:place])
    np.testing.assert_array_equal(window.t, t[chosen][first:last])
    assert rows.size == np.count_nonzero(chosen)


def test_fixes_of_a_long_track_are_made_as_those_of_a_short_one(monkeypatch: pytest.MonkeyPatch) -> None:
    expected = whole(hostile())
    monkeypatch.setattr(projected, "_MANY", 0)
    np.testing.assert_array_equal(whole(hostile()).lat_deg, expected.lat_deg)


def test_a_track_in_order_says_so() -> None:
    assert pieces(jumping(), 100).in_input_order
    assert not pieces(hostile(), 100).in_input_order


def test_facts_are_there_though_no_piece_was_taken() -> None:
    assert pieces(jumping(), 100).facts().distance == whole(jumping()).distance


def test_a_track_longer_than_what_is_held_is_worked_on_in_blocks(monkeypatch: pytest.MonkeyPatch) -> None:
    held: list[int] = []
    smoothing = course.Smoothing

    class Watched(smoothing):  # type: ignore[misc, valid-type]
        def rows(self, first: int, stop: int) -> object:
            found = super().rows(first, stop)
            held.append(sum(block.labels.size for block in self._solved.values()))
            return found

    monkeypatch.setattr(course, "Smoothing", Watched)
    monkeypatch.setattr(solve, "Course", lambda rows, labelled: Course(rows, labelled, 50))
    whole(jumping())
    assert max(held) <= 150


@pytest.mark.parametrize("rows", [0, -1, 2.5, True])
def test_a_piece_has_a_whole_number_of_rows(rows: object) -> None:
    with pytest.raises(InputError) as caught:
        clean_in_pieces([0.0], [1.0], [1.0], piece_rows=rows)  # type: ignore[arg-type]
    assert caught.value.field == "piece_rows"


def test_nothing_usable_is_no_fit_in_pieces_too() -> None:
    assert isinstance(clean_in_pieces([0.0], [np.nan], [0.0]), NoFit)


def test_the_covariance_is_that_of_the_variances() -> None:
    track = Drive.clean(MADE, height_m=np.full(MADE.t.size, 500.0))
    covariance = track.covariance_enu_m2
    np.testing.assert_array_equal(covariance[:, 0, 0], track.variance_m2)
    np.testing.assert_array_equal(covariance[:, 2, 2], track.variance_up_m2)
    assert np.all(covariance[:, 0, 1] == 0.0)


def test_a_stretch_too_long_to_be_read_at_once_is_cut_among_good_fixes(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    labels = np.tile(np.array([ENTRY] + [BURST] * 30 + [EXIT] + [NOMINAL] * 28, dtype=np.uint8), 20)
    assert doubtful(labels) == [slice(0, labels.size)]
    monkeypatch.setattr(reconcile, "_LONGEST", 200)
    parts = doubtful(labels)
    assert [part.start for part in parts[1:]] == [part.stop for part in parts[:-1]]
    assert (parts[0].start, parts[-1].stop) == (0, labels.size)
    assert all(part.stop - part.start <= 200 for part in parts)
    assert all(labels[part.start] == NOMINAL for part in parts[1:])
