"""Labels: what the beam says, forward and backward, and what each part of the door recognises."""

import doctest

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimators.arrays import FloatArray
from estimators.geodesy import plane
from estimators.trajectories import clean, clock, distance, measured_rows, options, ordering, projected, stale
from estimators.trajectories.clock import clock_shifts
from estimators.trajectories.distance import Way
from estimators.trajectories.estimation import Measured, estimate, label
from estimators.trajectories.labelling import backward, passage
from estimators.trajectories.labelling.backward import turned_round
from estimators.trajectories.labelling.modes import BURST, ENTRY, EXIT, LEVEL_STRIDE, REDRAW, SPIKE
from estimators.trajectories.parameters import TrackParameters
from tests.trajectories.drives import Drive, drive, with_bursts, with_spikes

PARAMETERS = TrackParameters(4.0, 1.0, 1.0)
BURSTING = (ENTRY, BURST, REDRAW)


def measured(made: Drive) -> Measured:
    return Measured(made.t, np.ascontiguousarray(made.fixes), None)


@pytest.mark.parametrize(
    "module",
    [backward, clean, clock, distance, measured_rows, options, ordering, passage, plane, projected, stale],
)
def test_the_examples_of_the_parts_are_true(module: object) -> None:
    found = doctest.testmod(module, extraglobs={"np": np})  # type: ignore[arg-type]
    assert found.attempted > 0
    assert found.failed == 0


@pytest.mark.parametrize("width", [1, 2, 6, 12])
@pytest.mark.parametrize("fixes", [1, 2, 3, 40])
def test_any_width_labels_any_number_of_fixes(width: int, fixes: int) -> None:
    made = drive(0, n=fixes)
    labels, probability, evidence = label(measured(made), PARAMETERS, 32, width=width)
    assert labels.size == fixes
    assert np.all((probability >= 0.0) & (probability <= 1.0))
    assert np.isfinite(evidence)


def test_forward_and_backward_agree_on_what_is_a_burst() -> None:
    made = with_bursts(drive(1))
    ahead = label(measured(made), PARAMETERS)[0]
    back = turned_round(label(measured(made).backward(), PARAMETERS)[0])
    np.testing.assert_array_equal(
        np.isin(ahead % LEVEL_STRIDE, BURSTING), np.isin(back % LEVEL_STRIDE, BURSTING)
    )
    np.testing.assert_array_equal(np.flatnonzero(ahead == ENTRY), np.flatnonzero(back == ENTRY))


@given(st.lists(st.integers(0, 7), max_size=40))
def test_turning_labels_round_keeps_what_is_spike_burst_or_good(kinds: list[int]) -> None:
    labels = np.array(kinds, dtype=np.uint8)
    turned = turned_round(labels)[::-1]
    np.testing.assert_array_equal(turned == SPIKE, labels == SPIKE)
    np.testing.assert_array_equal(np.isin(turned, BURSTING), np.isin(labels, BURSTING))


@given(st.lists(st.integers(0, 7), max_size=40))
def test_labels_turned_round_make_sense_forward(kinds: list[int]) -> None:
    inside = False
    for kind in turned_round(np.array(kinds, dtype=np.uint8)).tolist():
        assert kind != EXIT or inside
        assert kind not in (BURST, REDRAW) or inside
        if kind != SPIKE:
            inside = kind in BURSTING


def test_evidence_prefers_the_noise_that_made_the_track() -> None:
    made = measured(drive(2, n=800, sigma=5.0))
    found = {sigma: label(made, TrackParameters(sigma, 0.5, 1.0))[2] for sigma in (1.0, 5.0, 25.0)}
    assert max(found, key=found.__getitem__) == 5.0


def test_spikes_do_not_widen_the_noise() -> None:
    clean = estimate(measured(drive(3)))
    spiky = estimate(measured(with_spikes(drive(3), share=0.2)))
    assert abs(np.log(spiky.sigma / clean.sigma)) < 0.5


def test_a_clock_that_goes_wrong_and_right_again_shifts_what_is_between() -> None:
    t = np.arange(40.0)
    wrong = t.copy()
    wrong[10:20] += 30.0
    np.testing.assert_allclose(wrong + clock_shifts(wrong), t)


@given(st.permutations(range(30)))
def test_rows_in_any_disorder_are_no_clock_jump_of_most_rows(order: list[int]) -> None:
    assert np.count_nonzero(clock_shifts(np.array(order, dtype=np.float64))) <= 15


def test_a_path_is_not_longer_for_its_wiggles() -> None:
    rng = np.random.default_rng(0)
    places = np.column_stack([np.linspace(0.0, 1000.0, 1001), rng.normal(size=1001), np.zeros(1001)])
    assert _length(places, np.full(1001, 5.0)) == pytest.approx(1000.0, rel=0.02)
    assert _length(places, np.zeros(1001)) > 1300.0


def _length(places: FloatArray, sigma: FloatArray) -> float:
    way = Way()
    way.add(places, sigma)
    return way.length_m
