"""Every row in gets a row out, whatever it holds."""

import numpy as np
import pytest

from estimators import InputError, NoFit, NoFitReason, Track, TrackOptions, clean_trajectory, track_methods
from estimators.geodesy.plane import Plane
from tests.trajectories.drives import MUNICH, drive


def cleaned(*columns: object, **settings: object) -> Track:
    found = clean_trajectory(*columns, **settings)  # type: ignore[arg-type]
    assert isinstance(found, Track)
    return found


def test_rows_without_a_place_are_invalid_and_get_the_place_of_their_time() -> None:
    made = drive()
    lat, lon = MUNICH.locate(made.fixes)
    lat[10], lat[20], lon[30], lat[40], lon[40] = np.nan, 91.0, 400.0, 0.0, 0.0
    track = cleaned(made.t, lat, lon)
    rows = [10, 20, 30, 40]
    assert [track.points.reason[row] for row in rows] == ["invalid"] * 4
    assert not track.points.inlier[rows].any()
    assert np.isnan(track.points.probability[rows]).all()
    assert made.error(track) < 4.0
    assert "invalid_rows" in {item.code.value for item in track.notices}


def test_rows_without_a_time_have_no_place() -> None:
    made = drive()
    t = made.t.copy()
    t[5] = np.nan
    track = cleaned(t, *MUNICH.locate(made.fixes))
    assert np.isnan(track.lat_deg[5])
    assert track.points.reason[5] == "invalid"
    assert np.isfinite(np.delete(track.lat_deg, 5)).all()


def test_a_track_at_null_island_is_a_track() -> None:
    t = np.arange(50.0)
    lat = 1e-4 * (t - 25.0)
    track = cleaned(t, lat, np.zeros(50))
    assert "invalid" not in track.points.reason


def test_the_same_row_twice_is_a_duplicate_and_changes_nothing() -> None:
    made = drive()
    lat, lon = MUNICH.locate(made.fixes)
    once = cleaned(made.t, lat, lon)
    twice = cleaned(np.append(made.t, 100.0), np.append(lat, lat[100]), np.append(lon, lon[100]))
    assert sorted([twice.points.reason[100], twice.points.reason[-1]]) == ["duplicate", "ok"]
    assert twice.points.inlier[-1] == twice.points.inlier[100]
    np.testing.assert_allclose(twice.lat_deg[:-1], once.lat_deg, atol=1e-9)


def test_two_places_at_one_time_are_both_weighed() -> None:
    made = drive()
    lat, lon = MUNICH.locate(np.vstack([made.fixes, made.truth[100] + 500.0]))
    track = cleaned(np.append(made.t, 100.0), lat, lon)
    assert track.points.reason[-1] in ("spike", "burst")
    assert track.points.reason[100] == "ok"


def test_longitudes_beyond_180_are_wrapped() -> None:
    made = drive()
    lat, lon = Plane(-17.8, -178.0).locate(made.fixes)
    np.testing.assert_allclose(cleaned(made.t, lat, lon + 360.0).lon_deg, cleaned(made.t, lat, lon).lon_deg)


def test_a_repeated_position_of_a_moving_track_is_stale() -> None:
    made = drive(1)
    fixes = made.fixes.copy()
    fixes[150:190] = fixes[150]
    track = type(made)(made.t, fixes, made.truth, made.faulty).clean()
    assert set(track.points.reason[151:190]) == {"stale"}
    assert track.points.reason[149:151] == ["ok", "ok"]
    assert made.error(track) < 25.0
    assert "stale_positions" in {item.code.value for item in track.notices}


def test_repeats_by_coarse_rounding_are_honest() -> None:
    made = drive(2)
    t = made.t
    lat, lon = MUNICH.locate(0.05 * made.fixes)
    track = cleaned(t, lat.round(4), lon.round(4))
    assert "stale" not in track.points.reason
    assert track.points.inlier.mean() > 0.98


def test_a_clock_that_jumps_there_and_back_is_put_right() -> None:
    made = drive(3)
    t = made.t.copy()
    t[100:150] -= 20.0
    track = cleaned(t, *MUNICH.locate(made.fixes))
    assert set(track.points.reason[100:150]) == {"out_of_order"}
    assert "clock_jumped" in {item.code.value for item in track.notices}
    at = np.arange(100, 150) - 20
    off = made.places(track)[100:150] - made.truth[at]
    assert np.sqrt(np.mean(np.sum(off**2, axis=1))) < 6.0


def test_rows_in_disorder_are_sorted_not_flagged() -> None:
    made = drive(4)
    order = np.random.default_rng(0).permutation(made.t.size)
    lat, lon = MUNICH.locate(made.fixes)
    track = cleaned(made.t[order], lat[order], lon[order])
    assert "out_of_order" not in track.points.reason
    np.testing.assert_array_equal(track.lat_deg, cleaned(made.t, lat, lon).lat_deg[order])


def test_one_fix_is_an_answer() -> None:
    track = cleaned([0.0], [48.0], [11.0])
    assert track.lat_deg[0] == pytest.approx(48.0, abs=1e-9)
    assert track.sigma_m[0] > 1.0
    assert "few_fixes" in {item.code.value for item in track.notices}


def test_two_fixes_are_an_answer() -> None:
    track = cleaned([0.0, 10.0], [48.0, 48.001], [11.0, 11.0])
    assert track.points.inlier.all()
    assert np.isfinite(track.covariance_enu_m2[:, 0, 0]).all()


def test_a_position_that_never_changes_is_an_answer() -> None:
    track = cleaned(np.arange(100.0), np.full(100, 48.0), np.full(100, 11.0))
    assert track.points.inlier.all()
    np.testing.assert_allclose(track.lat_deg, 48.0, atol=1e-9)
    assert track.distance.cleaned.value == 0.0


def test_nothing_usable_is_no_fit_with_a_reason() -> None:
    found = clean_trajectory([0.0, 1.0], [np.nan, 91.0], [0.0, 0.0])
    assert isinstance(found, NoFit)
    assert found.reason is NoFitReason.no_data
    assert found.points.reason == ["invalid", "invalid"]
    assert isinstance(clean_trajectory([], [], []), NoFit)


def test_many_places_at_one_time_are_no_track() -> None:
    found = clean_trajectory([5.0, 5.0, 5.0], [1.0, 2.0, 3.0], [0.0, 0.0, 0.0])
    assert isinstance(found, NoFit)
    assert found.reason is NoFitReason.constant_time


def test_times_may_be_datetimes_or_iso_8601_with_mixed_zones() -> None:
    made = drive(0, n=60)
    lat, lon = MUNICH.locate(made.fixes)
    moments = np.datetime64("2026-03-01T10:00:00") + made.t.astype("timedelta64[s]")
    texts = [f"{moment}Z" for moment in moments]
    texts[1] = "2026-03-01T12:00:01+02:00"
    expected = cleaned(made.t, lat, lon).lat_deg
    np.testing.assert_array_equal(cleaned(moments, lat, lon).lat_deg, expected)
    np.testing.assert_array_equal(cleaned(texts, lat, lon).lat_deg, expected)


@pytest.mark.parametrize(
    ("field", "columns", "settings"),
    [
        ("lat_deg", ([0.0, 1.0], [1.0], [1.0, 2.0]), {}),
        ("lon_deg", ([0.0], [1.0], ["x"]), {}),
        ("t_s", ([[0.0]], [1.0], [1.0]), {}),
        ("t_s", ([0.0, 1e12], [1.0, 1.0], [1.0, 1.0]), {}),
        ("accuracy_m", ([0.0], [1.0], [1.0]), {"accuracy_m": [1.0, 2.0]}),
        ("height_m", ([0.0], [1.0], [1.0]), {"height_m": [True]}),
        ("method", ([0.0], [1.0], [1.0]), {"method": "magic"}),
        ("level", ([0.0], [1.0], [1.0]), {"level": 1.0}),
    ],
)
def test_a_callers_mistake_names_the_argument(
    field: str, columns: tuple[object, ...], settings: dict[str, object]
) -> None:
    with pytest.raises(InputError) as caught:
        clean_trajectory(*columns, **settings)  # type: ignore[arg-type]
    assert caught.value.field == field


@pytest.mark.parametrize("settings", [{"sigma_m": 0.0}, {"max_speed_mps": np.inf}, {"sigma_m": 1e-9}])
def test_options_out_of_range_are_refused(settings: dict[str, float]) -> None:
    with pytest.raises(InputError):
        TrackOptions(**settings)


@pytest.mark.parametrize("method", list(track_methods()))
def test_every_method_answers_row_for_row(method: str) -> None:
    made = drive(1)
    track = made.clean(method=method)
    assert track.method == method
    assert len(track) == made.t.size
    assert made.error(track) < 6.0


def test_a_given_sigma_is_kept() -> None:
    track = drive(1).clean(options=TrackOptions(sigma_m=7.0))
    assert track.noise.sigma_m == pytest.approx(7.0)
    assert track.noise.source == "given"


def test_a_top_speed_makes_what_is_faster_a_fault() -> None:
    made = drive(1)
    fixes = made.fixes.copy()
    fixes[200:] += np.array([0.0, 3000.0])
    jumped = type(made)(made.t, fixes, made.truth, made.faulty)
    assert jumped.clean(options=TrackOptions(max_speed_mps=30.0)).speed_mps.max() < 60.0
