import numpy as np
import pytest

from estimators.adapters.tracks import RowFault, read_track
from estimators.arrays import InputError


def gpx(inside: str, version: str = "1.1") -> bytes:
    space = f"http://www.topografix.com/GPX/{version.replace('.', '/')}"
    return f'<?xml version="1.0"?><gpx version="{version}" xmlns="{space}">{inside}</gpx>'.encode()


def point(second: int, more: str = "", lat: str = "50.0", lon: str = "7.0") -> str:
    time = f"<time>2021-07-28T07:00:{second:02d}Z</time>"
    return f'<trkpt lat="{lat}" lon="{lon}">{time}{more}</trkpt>'


def track_of(*points: str) -> str:
    return f"<trk><trkseg>{''.join(points)}</trkseg></trk>"


def test_segments_and_tracks_of_gpx_are_told_apart() -> None:
    first = f"<trk><name>bus</name><trkseg>{point(0)}{point(1)}</trkseg><trkseg>{point(9)}</trkseg></trk>"
    track = read_track(gpx(first + track_of(point(20))))
    assert track.segment is not None
    assert track.segment.tolist() == [0, 0, 1, 2]
    assert track.device_names() == ["bus", "bus", "bus", "track 2"]


def test_the_zone_in_which_a_time_was_written_is_kept() -> None:
    here = '<trkpt lat="35" lon="139"><time>2021-07-28T16:00:00.5+09:00</time></trkpt>'
    track = read_track(gpx(track_of(here)))
    assert track.time[0] == np.datetime64("2021-07-28T07:00:00.5")
    assert track.utc_offset_minutes is not None
    assert track.utc_offset_minutes.tolist() == [540]


def test_speed_and_course_of_gpx_1_0_are_read() -> None:
    track = read_track(
        gpx(track_of(point(0, "<course>90</course><speed>4.5</speed><hdop>0.9</hdop>")), "1.0")
    )
    assert track.speed_mps is not None
    assert track.bearing_deg is not None
    assert track.hdop is not None
    assert (track.speed_mps[0], track.bearing_deg[0], track.hdop[0]) == (4.5, 90.0, 0.9)


def test_speed_and_course_of_garmin_s_extension_are_read() -> None:
    inside = "<g:TrackPointExtension><g:speed>4.5</g:speed><g:course>271</g:course></g:TrackPointExtension>"
    more = f'<extensions xmlns:g="urn:garmin">{inside}</extensions>'
    track = read_track(gpx(track_of(point(0, more))))
    assert track.speed_mps is not None
    assert track.bearing_deg is not None
    assert (track.speed_mps[0], track.bearing_deg[0]) == (4.5, 271.0)


def test_the_time_of_a_point_is_its_own_and_not_that_of_an_extension() -> None:
    track = read_track(gpx(track_of(point(3, "<extensions><time>1999-01-01</time></extensions>"))))
    assert track.time[0] == np.datetime64("2021-07-28T07:00:03")


def test_a_point_that_cannot_be_read_stays_as_a_row_with_its_fault() -> None:
    timeless = '<trkpt lat="50" lon="7"/>'
    wrong_time = '<trkpt lat="50" lon="7"><time>yesterday</time></trkpt>'
    track = read_track(
        gpx(track_of(point(0), point(1, lat="91"), point(2, lat="north"), timeless, wrong_time))
    )
    assert [RowFault(code).name for code in track.fault] == [
        "none",
        "position_unreadable",
        "position_unreadable",
        "time_missing",
        "time_unreadable",
    ]
    assert np.isnan(track.lat[1:3]).all()
    assert np.isnat(track.time[3:]).all()


def test_an_export_is_well_read_in_the_encoding_that_it_declares() -> None:
    body = (
        '<?xml version="1.0" encoding="ISO-8859-1"?><gpx><trk><name>Zürich</name><trkseg>'
        f"{point(0)}</trkseg></trk></gpx>"
    )
    assert read_track(body.encode("latin-1")).devices == ("Zürich",)


@pytest.mark.parametrize(
    ("inside", "words"),
    [
        ('<rte><rtept lat="1" lon="2"/></rte>', "only routes, which are no tracks"),
        ('<wpt lat="1" lon="2"/>', "only waypoints, which are no tracks"),
        ("<trk><trkseg/></trk>", "no track points"),
        ('<trk><trkseg><trkpt lat="1" lon="2"/></trkseg></trk>', "no point of the track has a time"),
    ],
)
def test_gpx_without_a_track_says_what_it_holds_instead(inside: str, words: str) -> None:
    with pytest.raises(InputError, match=words):
        read_track(gpx(inside))
