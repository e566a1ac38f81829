"""``locate``: positions, faults, and what must not matter."""

from __future__ import annotations

import json
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from estimators import Fix, InputError, NoFit, NoFitReason, NoticeCode, PositionOptions, locate
from estimators.gnss.presentation.words import ADVICE
from estimators.notices import POSITION_NOTICES
from tests.gnss.skies import Sky, make_sky

SEEDS = st.integers(0, 10_000)


def fixed(sky: Sky, **settings_: object) -> Fix:
    found = locate(sky.satellites_m, sky.ranges_m, sigma_m=sky.sigma_m, satellite=sky.names, **settings_)  # type: ignore[arg-type]
    assert isinstance(found, Fix)
    return found


def horizontal_error(fix: Fix, sky: Sky) -> float:
    error = fix.error_enu_m(sky.truth_m)
    return float(np.hypot(error[0], error[1]))


@settings(max_examples=30, deadline=None)
@given(SEEDS, st.integers(5, 14))
def test_without_noise_the_position_is_exact_from_a_cold_start(seed: int, n: int) -> None:
    sky = make_sky(n, seed, noise=0.0)
    fix = fixed(sky)
    assert np.linalg.norm(fix.position_ecef_m - sky.truth_m) < 1e-3
    assert fix.clocks_m["G"] == pytest.approx(3000.0, abs=1e-3)
    assert fix.excluded == ()


@settings(max_examples=30, deadline=None)
@given(SEEDS, st.integers(0, 9))
def test_a_gross_fault_is_excluded_or_the_answer_says_that_it_may_be_wrong(seed: int, row: int) -> None:
    sky = make_sky(10, seed).with_faults({row: 300.0})
    fix = fixed(sky)
    assert fix.ambiguous or horizontal_error(fix, sky) < 20.0


def test_two_faults_of_twelve_are_found_and_explained() -> None:
    sky = make_sky(12, 5).with_faults({2: 150.0, 7: -400.0})
    fix = fixed(sky)
    assert set(fix.excluded) == {"G03", "G08"}
    assert fix.satellites.fault_probability[[2, 7]].min() > 0.99
    assert fix.satellites.residual_m[7] == pytest.approx(-400.0, abs=20.0)
    assert fix.global_test.p_value is not None
    assert fix.global_test.p_value > 0.001


@settings(max_examples=20, deadline=None)
@given(SEEDS, st.randoms())
def test_the_order_of_the_satellites_does_not_matter(seed: int, shuffler: object) -> None:
    sky = make_sky(10, seed).with_faults({1: 80.0, 4: -120.0})
    order = list(range(10))
    shuffler.shuffle(order)  # type: ignore[attr-defined]
    fix, other = fixed(sky), fixed(sky.taken(order))
    assert set(fix.excluded) == set(other.excluded)
    assert other.position_ecef_m == pytest.approx(fix.position_ecef_m, abs=1e-4)
    assert other.hpl_m == pytest.approx(fix.hpl_m, rel=1e-4)


@pytest.mark.parametrize("clock_m", [150_000.0, -144_000.0, 3e7])
def test_a_clock_error_common_to_all_changes_only_the_clock(clock_m: float) -> None:
    sky = make_sky(9, 3).with_faults({4: 90.0})
    shifted = sky.with_faults(dict.fromkeys(range(9), clock_m))
    fix, other = fixed(sky), fixed(shifted)
    assert other.position_ecef_m == pytest.approx(fix.position_ecef_m, abs=1e-3)
    assert other.excluded == fix.excluded
    assert other.clocks_m["G"] - fix.clocks_m["G"] == pytest.approx(clock_m, abs=1e-3)


def test_every_system_has_a_clock_of_its_own() -> None:
    sky = make_sky(14, 8).with_faults(dict.fromkeys(range(7, 14), 1234.0))
    systems = ["G"] * 7 + ["Galileo"] * 7
    fix = fixed(sky, system=systems)
    assert fix.clocks_m["E"] - fix.clocks_m["G"] == pytest.approx(1234.0, abs=15.0)
    assert fix.excluded == ()


def test_the_only_satellite_of_a_system_is_untestable() -> None:
    sky = make_sky(9, 2)
    fix = fixed(sky, system=["G"] * 8 + ["E"])
    assert fix.satellites.status[8] == "untestable"
    assert np.isinf(fix.satellites.mdb_m[8])
    assert NoticeCode.untestable_satellites in [item.code for item in fix.notices]


def test_positions_at_transmission_are_turned_with_the_earth() -> None:
    sky = make_sky(9, 4, noise=0.0)
    travel_s = np.linalg.norm(sky.satellites_m - sky.truth_m, axis=1) / 299792458.0
    angle = 7.2921151467e-5 * travel_s
    x, y, z = sky.satellites_m.T
    back = np.column_stack([np.cos(angle) * x - np.sin(angle) * y, np.cos(angle) * y + np.sin(angle) * x, z])
    turned = locate(back, sky.ranges_m, sigma_m=sky.sigma_m, rotated=False)
    kept = locate(back, sky.ranges_m, sigma_m=sky.sigma_m, rotated=True)
    assert isinstance(turned, Fix)
    assert isinstance(kept, Fix)
    assert np.linalg.norm(turned.position_ecef_m - sky.truth_m) < 1e-3
    # The error of leaving it out at 50 degrees of latitude is about 20 m (METHODS_GNSS).
    assert np.linalg.norm(kept.position_ecef_m - sky.truth_m) > 5.0


def test_as_many_satellites_as_unknowns_are_answered_with_a_warning() -> None:
    fix = fixed(make_sky(4, 1, noise=0.0))
    assert NoticeCode.unchecked_position in [item.code for item in fix.notices]
    assert set(fix.satellites.status) == {"untestable"}
    assert fix.ambiguous


def test_a_fault_that_five_satellites_cannot_place_is_called_ambiguous() -> None:
    sky = make_sky(5, 6).with_faults({0: 500.0})
    fix = fixed(sky)
    assert fix.ambiguous
    assert fix.rival is not None
    assert fix.rival.distance_m > 10.0
    assert NoticeCode.ambiguous_faults in [item.code for item in fix.notices]


def test_missing_and_masked_rows_keep_their_place() -> None:
    sky = make_sky(10, 11, mask_deg=5.0)
    ranges = sky.ranges_m.copy()
    ranges[3] = np.nan
    found = locate(
        sky.satellites_m, ranges, sigma_m=sky.sigma_m, options=PositionOptions(elevation_mask_deg=25.0)
    )
    assert isinstance(found, Fix)
    assert found.satellites.status[3] == "missing"
    assert len(found.satellites) == 10
    low = found.satellites.status.index("masked")
    assert not found.satellites.inlier[low]
    assert np.isnan(found.satellites.residual_m[low])


@pytest.mark.parametrize("n", [0, 1, 3])
def test_too_few_satellites_are_no_fit(n: int) -> None:
    sky = make_sky(8, 0).taken(list(range(n)))
    found = locate(sky.satellites_m, sky.ranges_m)
    assert isinstance(found, NoFit)
    assert found.reason is NoFitReason.too_few_satellites


def test_satellites_in_one_place_are_no_fit() -> None:
    sky = make_sky(8, 0)
    found = locate(np.repeat(sky.satellites_m[:1], 8, axis=0), sky.ranges_m)
    assert isinstance(found, NoFit)
    assert found.reason is NoFitReason.undetermined_geometry


@pytest.mark.parametrize(
    ("change", "field"),
    [
        (lambda sky: {"pseudoranges_m": sky.ranges_m / 1000.0}, "pseudoranges_m"),
        (lambda sky: {"pseudoranges_m": sky.ranges_m[:-1]}, "satellites_m"),
        (lambda sky: {"pseudoranges_m": sky.ranges_m * 1e9}, "pseudoranges_m"),
        (lambda sky: {"satellites_m": sky.satellites_m / 1000.0}, "satellites_m"),
        (lambda sky: {"satellites_m": sky.satellites_m[:, :2]}, "satellites_m"),
        (lambda _sky: {"satellites_m": [["a", "b", "c"]] * 8}, "satellites_m"),
        (lambda _sky: {"sigma_m": 0.0}, "sigma_m"),
        (lambda _sky: {"sigma_m": [1.0, 2.0]}, "sigma_m"),
        (lambda _sky: {"system": ["X"] * 8}, "system"),
        (lambda _sky: {"system": ["G"] * 7}, "system"),
        (lambda _sky: {"satellite": ["G01"] * 8}, "satellite"),
        (lambda _sky: {"cn0_dbhz": [400.0] * 8}, "cn0_dbhz"),
        (lambda _sky: {"method": "magic"}, "method"),
    ],
)
def test_what_cannot_be_an_epoch_is_refused_by_name(change: object, field: str) -> None:
    sky = make_sky(8, 0)
    arguments = {"satellites_m": sky.satellites_m, "pseudoranges_m": sky.ranges_m} | change(sky)  # type: ignore[operator]
    with pytest.raises(InputError) as caught:
        locate(**arguments)
    assert caught.value.field == field


@settings(max_examples=25, deadline=None)
@given(SEEDS, st.integers(0, 3))
def test_protection_levels_hold_where_no_warning_is_given(seed: int, faults: int) -> None:
    rng = np.random.default_rng(seed)
    rows = rng.choice(10, faults, replace=False)
    sky = make_sky(10, seed, noise=0.6).with_faults(
        {int(row): float(rng.choice([-1, 1]) * rng.uniform(20, 2000)) for row in rows}
    )
    fix = fixed(sky)
    assert fix.ambiguous or faults > 2 or horizontal_error(fix, sky) <= fix.hpl_m


def test_the_answer_is_json_geojson_frame_and_words() -> None:
    fix = fixed(make_sky(9, 5).with_faults({2: 900.0}))
    answer = json.loads(json.dumps(fix.to_dict(), allow_nan=False))
    assert answer["satellites"]["status"][2] == "excluded"
    longitude, latitude, _ = fix.to_geojson()["geometry"]["coordinates"]
    assert (latitude, longitude) == pytest.approx((fix.geodetic.lat_deg, fix.geodetic.lon_deg), abs=1e-8)
    assert list(fix.to_frame()["satellite"]) == list(fix.satellites.name)
    assert "G03" in fix.summary()
    assert max(map(len, fix.summary().splitlines())) <= 80


def test_the_same_epoch_gives_the_same_bytes() -> None:
    sky = make_sky(12, 9).with_faults({3: 70.0})
    assert json.dumps(fixed(sky).to_dict()) == json.dumps(fixed(sky).to_dict())


def _codes(**change: object) -> set[NoticeCode]:
    sky = make_sky(9, 2, mask_deg=5.0)
    arguments: dict[str, object] = {"sigma_m": sky.sigma_m} | change
    found = locate(sky.satellites_m, sky.ranges_m, **arguments)  # type: ignore[arg-type]
    assert isinstance(found, Fix)
    return {item.code for item in found.notices}


POSITION_CASES: dict[NoticeCode, Callable[[], set[NoticeCode]]] = {
    NoticeCode.ambiguous_faults: lambda: {
        item.code for item in fixed(make_sky(5, 6).with_faults({0: 500.0})).notices
    },
    NoticeCode.unchecked_position: lambda: {item.code for item in fixed(make_sky(4, 1)).notices},
    NoticeCode.untestable_satellites: lambda: _codes(system=["G"] * 8 + ["E"]),
    NoticeCode.unbounded_error: lambda: {item.code for item in fixed(make_sky(5, 1)).notices},
    NoticeCode.inconsistent_ranges: lambda: _codes(sigma_m=0.01, method="ols"),
    NoticeCode.satellites_below_mask: lambda: _codes(options=PositionOptions(elevation_mask_deg=35.0)),
}


@pytest.mark.parametrize("code", sorted(POSITION_NOTICES))
def test_every_notice_of_positions_occurs_and_says_what_to_do(code: NoticeCode) -> None:
    assert code in POSITION_CASES[code]()
    assert ADVICE[code].endswith(".")
