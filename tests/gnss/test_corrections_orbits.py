import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from estimators.gnss.calendar import GPS_EPOCH, gps_to_utc, of_week, utc_to_gps
from estimators.gnss.orbits.ephemerides import NONE, UNHEALTHY, Ephemeris, stack_ephemerides
from estimators.gnss.orbits.glonass import BIAS
from estimators.gnss.orbits.kepler import COLUMNS, eccentric_anomaly
from estimators.gnss.orbits.states import satellite_states

GLONASS = (10908942.38281, -2885726.074219, 22883539.55078, 1407.80639648, 2795.85552216, -316.99848175)
GPS = (5153.7, 0.01, 0.3, 4.5e-9, 1.0, 0.96, 0.5, -8e-9, 1e-10, *(0.0,) * 6, 7200.0, 1e-4, 1e-12, 0.0)


def glonass(toe_s: float = 0.0, healthy: bool = True, **changed: tuple[float, ...]) -> Ephemeris:
    state = changed.get("state", GLONASS)
    toe = of_week(2111, toe_s)
    return Ephemeris("R01", toe, toe, (*state, -1.9e-6, 0.0, -2.8e-6, 6e-5, 0.0), healthy, 5.0, {1: 0.0}, 1)


def gps(toe_s: float, healthy: bool = True) -> Ephemeris:
    toe = of_week(2111, toe_s)
    elements = (*GPS[:15], toe_s, *GPS[16:], 3.9860050e14, 7.2921151467e-5, 0.0)
    return Ephemeris("G01", toe, toe, elements, healthy, 2.4, {1: 0.0})


def states_at(ephemeris: Ephemeris, seconds: float):
    table = stack_ephemerides([ephemeris], COLUMNS)
    time = np.array([ephemeris.toe_ns + round(seconds * 1e9)])
    return satellite_states(table, np.array([0]), time, np.array([0.0]))


@settings(deadline=None)
@given(st.floats(-np.pi, np.pi), st.floats(0.0, 0.5))
def test_keplers_equation_is_solved(mean: float, eccentricity: float) -> None:
    anomaly = eccentric_anomaly(mean, eccentricity)
    assert abs(anomaly - eccentricity * np.sin(anomaly) - mean) < 1e-12


@settings(deadline=None)
@given(st.floats(-1800.0, 1800.0))
def test_a_glonass_satellite_carried_forth_and_back_returns(seconds: float) -> None:
    there = states_at(glonass(), seconds + 6e-5)
    state = (*there.position_m[0], *there.velocity_mps[0])
    back = states_at(glonass(state=state), -seconds + 6e-5)
    assert np.abs(back.position_m[0] - GLONASS[:3]).max() < 0.01


def test_velocities_are_the_slopes_of_positions() -> None:
    for ephemeris in (gps(7200.0), glonass()):
        early, late = states_at(ephemeris, 599.0), states_at(ephemeris, 601.0)
        slope = (late.position_m - early.position_m) / 2.0
        assert np.abs(states_at(ephemeris, 600.0).velocity_mps - slope).max() < 0.001


def test_the_satellite_clock_drifts_as_it_says() -> None:
    early, late = states_at(gps(7200.0), 100.0), states_at(gps(7200.0), 101.0)
    assert abs((late.clock_s - early.clock_s)[0] - early.drift[0]) < 1e-15


def test_the_nearest_ephemeris_serves() -> None:
    table = stack_ephemerides([gps(7200.0), gps(0.0), gps(14400.0)], COLUMNS)
    times = np.array([of_week(2111, s) for s in (100.0, 5000.0, 12000.0)])
    assert table.choose(("G01",), np.zeros(3, dtype=np.int64), times).tolist() == [0, 1, 2]


def test_an_old_ephemeris_does_not_serve() -> None:
    table = stack_ephemerides([gps(0.0), glonass(0.0)], COLUMNS)
    times = np.array([of_week(2111, s) for s in (7200.0, 7201.0, 1800.0, 1801.0)])
    chosen = table.choose(("G01", "R01"), np.array([0, 0, 1, 1]), times)
    assert chosen.tolist() == [0, NONE, 1, NONE]


def test_a_satellite_that_says_it_is_ill_is_told_from_one_unknown() -> None:
    table = stack_ephemerides([gps(0.0, healthy=False)], COLUMNS)
    chosen = table.choose(("G01", "G02"), np.array([0, 1]), np.full(2, of_week(2111, 0.0)))
    assert chosen.tolist() == [UNHEALTHY, NONE]


def test_of_two_ephemerides_for_one_time_the_last_counts() -> None:
    second = glonass(state=tuple(2.0 * v for v in GLONASS))
    table = stack_ephemerides([glonass(), second], COLUMNS)
    assert table.elements[:, 0].tolist() == [2.0 * GLONASS[0]]
    assert table.elements[0, BIAS] == 6e-5


@settings(deadline=None)
@given(st.integers(0, 2**61))
def test_utc_and_gps_time_are_each_others_inverse(nanoseconds: int) -> None:
    time = np.array([GPS_EPOCH + np.timedelta64(nanoseconds, "ns")])
    utc = gps_to_utc(time)
    assert abs(utc_to_gps(utc) - time)[0] in {np.timedelta64(0, "ns"), np.timedelta64(1, "s")}
    assert gps_to_utc(utc_to_gps(utc))[0] == utc[0]
