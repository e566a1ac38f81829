"""Whatever is sent, a reader answers with a recording or an ``InputError``."""

import io
import zipfile

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from estimators.adapters.tracks import read_track
from estimators.arrays import InputError
from tests.adapters.tracks.fit_files import activity, fit_file

CSV = b"time,lat,lon,device,speed\n2021-07-28T07:00:00+02:00,50,7,a,1\n2021-07-28T07:00:01Z,50,7,b,2\n"
GPX = (
    b'<?xml version="1.0" encoding="UTF-8"?><gpx version="1.1"><trk><name>a</name><trkseg>'
    b'<trkpt lat="50" lon="7"><ele>3</ele><time>2021-07-28T07:00:00Z</time><extensions><speed>1</speed>'
    b"</extensions></trkpt></trkseg></trk></gpx>"
)
KML = (
    b"<kml><Placemark><name>a</name><gx:Track><when>2021-07-28T07:00:00Z</when><gx:coord>7 50 3</gx:coord>"
    b'<gx:SimpleArrayData name="speed"><gx:value>1</gx:value></gx:SimpleArrayData></gx:Track></Placemark>'
    b"</kml>"
)
GEOJSON = (
    b'{"type":"FeatureCollection","features":[{"type":"Feature","geometry":{"type":"MultiLineString",'
    b'"coordinates":[[[7,50],[7,51]],[[8,50,1]]]},"properties":{"coordTimes":[["2021-07-28","2021-07-29"],[5]]}},'
    b'{"type":"Feature","geometry":{"type":"Point","coordinates":[7,50]},"properties":{"time":1,"hdop":2}}]}'
)
NMEA = (
    b"$GPRMC,120000,A,4807.038,N,01131.000,E,022.4,084.4,280721,003.1,W\r\n"
    b"$GPGGA,120000,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,\r\n$GPGST,120000,1,3,2,45,2,2,4\r\n"
    b"$GPVTG,054.7,T,034.4,M,005.5,N,010.2,K\r\n$GPZDA,120001,28,07,2021,00,00\r\n$GPGLL,4807,N,01131,E,120002,A"
)


def kmz() -> bytes:
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr(zipfile.ZipInfo("doc.kml"), KML)
    return packed.getvalue()


def tables() -> dict[str, bytes]:
    table = pa.table({"time": [0.0, 1.0], "lat": [50.0, 51.0], "lon": [7.0, 7.0], "device": ["a", "b"]})
    packed, streamed = io.BytesIO(), io.BytesIO()
    pq.write_table(table, packed)
    with pa.ipc.new_stream(streamed, table.schema) as writer:
        writer.write_table(table)
    return {"parquet": packed.getvalue(), "arrow": streamed.getvalue()}


SOUND = {
    "csv": CSV,
    "gpx": GPX,
    "kml": KML,
    "kmz": kmz(),
    "geojson": GEOJSON,
    "nmea": NMEA,
    "fit": activity(3),
}

EDITS = st.lists(
    st.tuples(st.floats(0.0, 1.0), st.integers(0, 3), st.binary(min_size=1, max_size=6)),
    min_size=1,
    max_size=8,
)


def changed(body: bytes, edits: list[tuple[float, int, bytes]]) -> bytes:
    """The file with bytes put in, taken out, replaced, or cut off."""
    for place, kind, new in edits:
        at = int(place * len(body))
        body = {
            0: body[:at] + new + body[at:],
            1: body[:at] + body[at + len(new) :],
            2: body[:at] + new + body[at + len(new) :],
            3: body[:at] if place > 0.5 else body,
        }[kind]
    return body


def check(body: bytes) -> None:
    """Every row of a recording is sound: NaN, or in range."""
    try:
        track = read_track(body, most_bytes=1 << 20)
    except InputError:
        return
    assert len(track) > 0
    known = ~np.isnan(track.lat)
    assert (np.abs(track.lat[known]) <= 90.0).all()
    assert (np.abs(track.lon[known]) <= 180.0).all()
    assert (known == ((track.fault == 0) | (track.fault > 2))).all()


@pytest.mark.parametrize("form", SOUND)
@settings(max_examples=150, deadline=None)
@given(edits=EDITS)
def test_a_changed_file_is_read_or_refused(form: str, edits: list[tuple[float, int, bytes]]) -> None:
    check(changed(SOUND[form], edits))


@settings(max_examples=300, deadline=None)
@given(edits=EDITS)
def test_changed_fit_messages_under_a_right_checksum_are_read_or_refused(
    edits: list[tuple[float, int, bytes]],
) -> None:
    check(fit_file(changed(activity(3)[14:-2], edits)))


@pytest.mark.parametrize("form", ["parquet", "arrow"])
@settings(max_examples=100, deadline=None)
@given(edits=EDITS)
def test_a_changed_table_is_read_or_refused(form: str, edits: list[tuple[float, int, bytes]]) -> None:
    check(changed(tables()[form], edits))


@settings(max_examples=300, deadline=None)
@given(st.binary(max_size=200))
def test_any_bytes_are_read_or_refused(body: bytes) -> None:
    check(body)


@settings(max_examples=200, deadline=None)
@given(
    st.binary(max_size=60),
    st.sampled_from([b"PAR1", b"ARROW1", b"\xff\xff\xff\xff", b"\x1f\x8b", b"PK\x03\x04"]),
)
def test_any_bytes_behind_a_format_s_mark_are_read_or_refused(body: bytes, mark: bytes) -> None:
    check(mark + body)


@pytest.mark.parametrize("form", SOUND)
def test_the_files_that_are_changed_are_sound_themselves(form: str) -> None:
    assert (read_track(SOUND[form]).fault == 0).any()


BOMB = (
    b'<?xml version="1.0"?><!DOCTYPE gpx [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;">'
    b'<!ENTITY c "&b;&b;&b;&b;&b;&b;&b;&b;">]><gpx><trk><name>&c;</name></trk></gpx>'
)
EXTERNAL = (
    b'<?xml version="1.0"?><!DOCTYPE gpx [<!ENTITY x SYSTEM "file:///etc/hostname">]>'
    b"<gpx><trk><name>&x;</name></trk></gpx>"
)
REMOTE = b'<?xml version="1.0"?><!DOCTYPE gpx SYSTEM "http://127.0.0.1:9/gpx.dtd"><gpx/>'


@pytest.mark.parametrize("body", [BOMB, EXTERNAL, REMOTE])
def test_xml_that_declares_entities_is_refused(body: bytes) -> None:
    with pytest.raises(InputError, match="DOCTYPE"):
        read_track(body)


def test_xml_that_is_nested_without_end_is_refused() -> None:
    with pytest.raises(InputError, match="deep"):
        read_track(b"<gpx>" + b"<a>" * 100_000)


def test_an_unknown_encoding_is_refused() -> None:
    with pytest.raises(InputError, match="encoding"):
        read_track(b'<?xml version="1.0" encoding="nonsense"?><gpx></gpx>')


def test_an_archive_that_unpacks_beyond_the_limit_is_refused() -> None:
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("doc.kml", b"<kml>" + b" " * 5_000_000)
    with pytest.raises(InputError, match="more than 1000000 bytes"):
        read_track(packed.getvalue(), most_bytes=1_000_000)
