from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from estimators.arrays import InputError
from estimators.geodesy.ellipsoid import to_geodetic
from estimators.gnss.carriers import L1_HZ
from estimators.gnss.corrections.ionosphere_free import ionosphere_free
from estimators.gnss.corrections.klobuchar import Klobuchar, klobuchar_delay
from estimators.gnss.corrections.saastamoinen import saastamoinen_delay
from estimators.gnss.raw import correct_ranges
from estimators.gnss.snapshot.linearise import EARTH_RATE, SPEED_OF_LIGHT
from tests.gnss.recorded import Recorded, read_recorded

ESBC = Klobuchar(
    (4.6566e-09, 1.4901e-08, -5.9605e-08, -1.1921e-07), (8.1920e04, 9.8304e04, -6.5536e04, -5.2429e05)
)


@pytest.fixture(scope="module")
def esbc(gnss_data: Path) -> Recorded:
    return read_recorded(gnss_data, "esbc")


def corrected(table: Recorded, **options):
    """The table's raw ranges of its first epochs, through the corrections."""
    c = table.columns
    arguments = {
        "time_gps": table.time_gps,
        "offsets": table.offsets,
        "satellite_clock_s": c["sat_clk_m"] / SPEED_OF_LIGHT,
        "system": [name[0] for name in table.satellite],
        "satellite": table.satellite,
        "rotated": True,
        "klobuchar": ESBC,
        "mask_deg": 5.0,
    }
    return correct_ranges(table.positions, c["raw_pr_m"], **(arguments | options))


def test_klobuchar_gives_the_delays_of_rtklib(esbc: Recorded) -> None:
    c = esbc.columns
    latitude, longitude, _ = to_geodetic(esbc.truth)
    delay = klobuchar_delay(c["tow"], latitude, longitude, c["az_deg"], c["el_deg"], ESBC)
    at_l1 = np.array([name[0] in "GE" for name in esbc.satellite])
    assert np.abs(delay - c["iono_m"])[at_l1].max() < 0.002


def test_saastamoinen_gives_the_zenith_delay_of_rtklib(esbc: Recorded) -> None:
    latitude, _, height = to_geodetic(esbc.truth)
    c = esbc.columns
    zenith = c["tropo_m"] * np.sin(np.radians(c["el_deg"]))
    assert np.abs(saastamoinen_delay(latitude, height, 90.0) - zenith).max() < 0.001


@pytest.mark.parametrize("elevation", [90.0, 60.0, 30.0, 15.0, 10.0, 7.0, 5.0])
def test_aslant_the_troposphere_is_as_long_as_along_traced_rays(elevation: float) -> None:
    # Niell 1996, "Global mapping functions for the atmosphere delay at radio wavelengths", table 3:
    # hydrostatic, 45 degrees, yearly average.
    a, b, c = 1.2465397e-3, 2.9288445e-3, 63.721774e-3
    sine = np.sin(np.radians(elevation))
    niell = (1.0 + a / (1.0 + b / (1.0 + c))) / (sine + a / (sine + b / (sine + c)))
    delay = saastamoinen_delay(45.0, 0.0, [90.0, elevation])
    assert delay[1] / delay[0] == pytest.approx(niell, rel=0.01)


def test_the_atmosphere_is_found_from_a_cold_start(esbc: Recorded) -> None:
    observed = corrected(esbc)
    rows = observed.source_row
    c = esbc.columns
    assert rows.size == c["tow"].size
    assert np.abs(observed.elevation_deg - c["el_deg"][rows]).max() < 0.01
    latitude, _, height = to_geodetic(esbc.truth)
    troposphere = saastamoinen_delay(latitude, height, c["el_deg"][rows])
    assert np.abs(observed.troposphere_m - troposphere).max() < 0.02
    # BeiDou on its own carrier; GLONASS satellites have one each, which this table does not say.
    known = np.array([esbc.satellite[row][0] != "R" for row in rows])
    assert np.abs(observed.ionosphere_m - c["iono_m"][rows])[known].max() < 0.01
    assert np.abs(observed.ionosphere_m - c["iono_m"][rows]).max() < 0.05


def test_but_for_the_troposphere_ranges_differ_from_rtklibs_by_a_group_delay_per_satellite(
    esbc: Recorded,
) -> None:
    observed = corrected(esbc)
    theirs = esbc.columns["corr_pr_m"] + esbc.columns["tropo_m"]
    difference = observed.table.pseudoranges_m + observed.troposphere_m - theirs[observed.source_row]
    names = np.array(observed.table.names)
    gps = sorted({name for name in observed.table.names if name[0] == "G"})
    assert max(np.ptp(difference[names == name]) for name in gps) < 0.03


def test_positions_at_transmission_are_turned_to_reception(esbc: Recorded) -> None:
    way = np.linalg.norm(esbc.positions - esbc.truth, axis=1)
    angle = EARTH_RATE * way / SPEED_OF_LIGHT
    x, y, z = esbc.positions.T
    earlier = np.column_stack(
        [np.cos(angle) * x - np.sin(angle) * y, np.sin(angle) * x + np.cos(angle) * y, z]
    )
    c = esbc.columns
    observed = correct_ranges(
        earlier,
        c["raw_pr_m"],
        time_gps=esbc.time_gps,
        offsets=esbc.offsets,
        satellite_clock_s=c["sat_clk_m"] / SPEED_OF_LIGHT,
        system=[name[0] for name in esbc.satellite],
    )
    assert observed.table.rotated
    assert np.abs(observed.table.satellites_m - esbc.positions[observed.source_row]).max() < 0.01


def test_a_gross_fault_hardly_changes_the_corrections_of_the_others(esbc: Recorded) -> None:
    raw = esbc.columns["raw_pr_m"].copy()
    raw[esbc.offsets[:-1]] += 300e3
    healthy = corrected(esbc)
    wrong = correct_ranges(
        esbc.positions,
        raw,
        time_gps=esbc.time_gps,
        offsets=esbc.offsets,
        satellite_clock_s=esbc.columns["sat_clk_m"] / SPEED_OF_LIGHT,
        system=[name[0] for name in esbc.satellite],
        rotated=True,
        klobuchar=ESBC,
        mask_deg=5.0,
    )
    assert np.abs(wrong.elevation_deg - healthy.elevation_deg).max() < 0.02
    assert np.abs(wrong.troposphere_m - healthy.troposphere_m).max() < 0.2


def test_satellites_under_the_mask_are_left_out_and_named(esbc: Recorded) -> None:
    observed = corrected(esbc, mask_deg=30.0)
    under = esbc.columns["el_deg"] < 30.0
    assert observed.elevation_deg.min() >= 30.0
    assert set(observed.left_out.reason) == {"masked"}
    assert abs(len(observed.left_out) - under.sum()) <= 2
    row = int(observed.left_out.source_row[0])
    assert observed.left_out.satellite[0] == esbc.satellite[row]


def test_a_missing_range_is_left_out_and_named(esbc: Recorded) -> None:
    raw = esbc.columns["raw_pr_m"][: esbc.offsets[1]].copy()
    raw[2] = np.nan
    observed = correct_ranges(esbc.positions[: raw.size], raw, time_gps=esbc.time_gps[:1], mask_deg=-10)
    assert (observed.left_out.reason, observed.left_out.source_row.tolist()) == (("missing",), [2])
    assert observed.table.pseudoranges_m.size == raw.size - 1


def test_an_epoch_with_too_few_satellites_borrows_the_place_of_its_neighbour(esbc: Recorded) -> None:
    few, many = slice(0, 2), slice(esbc.offsets[1], esbc.offsets[2])
    rows = np.r_[few, many]
    c = esbc.columns
    observed = correct_ranges(
        esbc.positions[rows],
        c["raw_pr_m"][rows],
        time_gps=esbc.time_gps[:2],
        offsets=[0, 2, rows.size],
        satellite_clock_s=c["sat_clk_m"][rows] / SPEED_OF_LIGHT,
        rotated=True,
    )
    assert np.abs(observed.elevation_deg[:2] - c["el_deg"][:2]).max() < 0.05


@pytest.mark.parametrize("height", [40e3 + 1, 2e6])
def test_no_troposphere_is_left_above_its_top(height: float) -> None:
    assert saastamoinen_delay(45.0, height, 90.0).tolist() == [0.0]


@settings(deadline=None)
@given(st.floats(-90.0, 0.0), st.floats(0.0, 360.0), st.floats(-90.0, 90.0))
def test_satellites_under_the_horizon_get_no_delay(elevation: float, azimuth: float, latitude: float) -> None:
    assert klobuchar_delay(0.0, latitude, 10.0, azimuth, elevation, ESBC)[0] == 0.0
    assert saastamoinen_delay(latitude, 100.0, elevation)[0] == 0.0


@settings(deadline=None)
@given(st.floats(0.0, 604800.0), st.floats(-90.0, 90.0), st.floats(-180.0, 180.0), st.floats(0.0, 360.0))
def test_the_ionosphere_is_between_the_night_and_a_hundred_metres(
    second: float, latitude: float, longitude: float, azimuth: float
) -> None:
    delay = klobuchar_delay(second, latitude, longitude, azimuth, [90.0, 10.0], ESBC)
    assert 5e-9 * SPEED_OF_LIGHT * 0.99 < delay[0] < delay[1] < 100.0


@settings(deadline=None)
@given(st.floats(2e7, 3e7), st.floats(0.0, 100.0), st.sampled_from([1227.60e6, 1176.45e6, 1207.14e6]))
def test_two_codes_give_the_range_without_ionosphere(distance: float, delay: float, other: float) -> None:
    first, second = distance + delay, distance + delay * (L1_HZ / other) ** 2
    combined, gain = ionosphere_free(*(np.array([v]) for v in (first, second, L1_HZ, other)))
    assert combined[0] == pytest.approx(distance, abs=1e-5)
    assert 2.0 < gain[0] < 4.0


def test_rows_without_a_second_code_are_left_out(esbc: Recorded) -> None:
    n = int(esbc.offsets[1])
    second = esbc.columns["raw_pr_m"][:n].copy()
    second[:3] = np.nan
    observed = correct_ranges(
        esbc.positions[:n],
        esbc.columns["raw_pr_m"][:n],
        time_gps=esbc.time_gps[:1],
        second_m=second,
        second_hz=np.full(n, 1227.60e6),
        mask_deg=-10,
    )
    assert observed.left_out.reason == ("one_code",) * 3
    assert observed.ionosphere == "dual"
    assert not observed.ionosphere_m.any()


@pytest.mark.parametrize(
    ("field", "options"),
    [
        ("satellite_clock_s", {"satellite_clock_s": [1e5] * 8}),
        ("satellite_clock_s", {"satellite_clock_s": [0.0] * 3}),
        ("time_gps", {"time_gps": "yesterday"}),
        ("time_gps", {"time_gps": np.array(["2020-01-01", "2020-01-02"], dtype="datetime64[s]")}),
        ("offsets", {"offsets": [0, 5]}),
        ("offsets", {"offsets": [0, 9, 8]}),
        ("frequency_hz", {"frequency_hz": [1575.42] * 8}),
        ("second_hz", {"second_m": [2e7] * 8}),
        ("mask_deg", {"mask_deg": float("nan")}),
        ("weights", {"weights": "guess"}),
        ("system", {"system": ["G"] * 3}),
        ("satellite", {"satellite": ["G01"] * 8}),
        ("velocities_mps", {"velocities_mps": [[1.0, 2.0]] * 8}),
    ],
)
def test_what_cannot_be_epochs_is_refused_by_field(esbc: Recorded, field: str, options: dict) -> None:
    arguments = {"time_gps": np.datetime64("2020-06-25T00:00:00")} | options
    with pytest.raises(InputError) as refused:
        correct_ranges(esbc.positions[:8], esbc.columns["raw_pr_m"][:8], **arguments)
    assert refused.value.field == field


@pytest.mark.parametrize("bad", [(1.0, 2.0, 3.0), (1.0, 2.0, 3.0, np.nan), (1e9, 0.0, 0.0, 0.0)])
def test_impossible_coefficients_are_refused(bad: tuple[float, ...]) -> None:
    with pytest.raises(InputError, match="coefficients"):
        Klobuchar(bad, (0.0, 0.0, 0.0, 0.0))
