from pathlib import Path

import numpy as np
import pytest

from estimators.adapters.tracks import read_track, write_csv, write_geojson, write_gpx
from estimators.arrays import InputError

READ = {
    "ais_evergiven_boat_positions.csv": ("csv", 22_287),
    "geolife_small.csv": ("csv", 5_908),
    "gnss_lib_py_pixel6.nmea": ("nmea", 48),
    "gpxpy_cerknicko-jezero.gpx": ("gpx", 296),
    "gpxpy_korita-zbevnica.gpx": ("gpx", 871),
    "liverpool_bus_route14.csv": ("csv", 1_533),
    "tracklib_sep_FC_garmin.gpx": ("gpx", 6_870),
    "tracklib_sep_FC_polar.gpx": ("gpx", 5_975),
    "tracklib_sep_FC_telephone.gpx": ("gpx", 589),
}
TIMELESS = ["gpxpy_track-with-extremes.gpx", "gpxpy_track_with_dilution_errors.gpx"]


@pytest.mark.parametrize("name", READ)
def test_a_real_file_is_read_whole(track_files: Path, name: str) -> None:
    track = read_track(track_files / name)
    assert (track.form, len(track)) == READ[name]
    assert not np.isnan(track.lat).any()


@pytest.mark.parametrize("name", TIMELESS)
def test_a_real_file_without_times_says_so(track_files: Path, name: str) -> None:
    with pytest.raises(InputError, match="no point of the track has a time"):
        read_track(track_files / name)


def test_four_devices_on_one_run_agree_where_and_when_they_were(track_files: Path) -> None:
    tracks = [
        read_track(track_files / f"tracklib_sep_FC_{name}.gpx") for name in ("garmin", "polar", "telephone")
    ]
    for track in tracks:
        assert track.time[0].astype("datetime64[h]") == np.datetime64("2021-07-28T07")
        assert abs(np.median(track.lat) - 48.8295) < 1e-3
        assert abs(np.median(track.lon) - 2.4388) < 1e-3


def test_the_phone_s_own_zone_is_kept(track_files: Path) -> None:
    track = read_track(track_files / "tracklib_sep_FC_telephone.gpx")
    assert track.utc_offset_minutes is not None
    assert set(track.utc_offset_minutes.tolist()) == {120}
    assert b"<time>2021-07-28T09:19:04+02:00</time>" in b"".join(write_gpx(track))


def test_points_without_times_among_others_stay_as_rows(track_files: Path) -> None:
    track = read_track(track_files / "gpxpy_korita-zbevnica.gpx")
    assert np.count_nonzero(np.isnat(track.time)) == np.count_nonzero(track.fault) == 358


def test_a_ship_s_dates_are_read_days_first(track_files: Path) -> None:
    track = read_track(track_files / "ais_evergiven_boat_positions.csv")
    assert track.time[0] == np.datetime64("2021-03-20T00:22")


@pytest.mark.parametrize("name", READ)
def test_a_real_track_survives_a_round_trip(track_files: Path, name: str) -> None:
    track = read_track(track_files / name)
    for body in (write_csv(track), write_gpx(track), write_geojson(track, points=True)):
        back = read_track(b"".join(body))
        order = np.arange(len(track))
        if back.form == "gpx":
            keys = [key for key in (track.segment, track.device) if key is not None]
            order = np.lexsort(keys) if keys else order
        np.testing.assert_allclose(back.lat, track.lat[order], rtol=0, atol=5.1e-11)
        np.testing.assert_allclose(back.lon, track.lon[order], rtol=0, atol=5.1e-11)
        np.testing.assert_array_equal(back.time, track.time[order])
