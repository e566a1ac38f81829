import numpy as np
import pytest

from estimators.adapters.tracks import RowFault, read_track
from estimators.arrays import InputError


def sentence(body: str) -> str:
    total = 0
    for character in body:
        total ^= ord(character)
    return f"${body}*{total:02X}"


def log(*bodies: str) -> bytes:
    return "\r\n".join(map(sentence, bodies)).encode()


def rmc(clock: str, date: str = "280721", talker: str = "GP", status: str = "A") -> str:
    return f"{talker}RMC,{clock},{status},4807.038,N,01131.000,E,022.4,084.4,{date},003.1,W"


def gga(clock: str, talker: str = "GP", quality: int = 1) -> str:
    return f"{talker}GGA,{clock},4807.038,N,01131.000,E,{quality},08,0.9,545.4,M,46.9,M,,"


def test_sentences_of_the_same_moment_become_one_row() -> None:
    gst = "GPGST,120000,1.0,3.0,2.0,45.0,2.5,2.5,4.0"
    track = read_track(log(rmc("120000"), gga("120000"), gst, rmc("120001"), gga("120001")))
    assert len(track) == 2
    assert track.time[0] == np.datetime64("2021-07-28T12:00:00")
    assert track.lat[0] == pytest.approx(48.1173, abs=1e-9)
    assert track.speed_mps is not None
    assert track.speed_mps[0] == pytest.approx(22.4 * 0.514444, rel=1e-5)
    assert track.ellipse_major_m is not None
    assert track.ellipse_bearing_deg is not None
    assert (track.ellipse_major_m[0], track.ellipse_bearing_deg[0]) == (3.0, 45.0)
    assert track.height_m is not None
    assert track.height_m.tolist() == [545.4, 545.4]


def test_the_accuracy_of_a_round_error_holds_68_percent() -> None:
    track = read_track(log(rmc("120000"), "GPGST,120000,,,,,2.0,2.0,4.0"))
    assert track.accuracy_m is not None
    assert 1.0 - np.exp(-(track.accuracy_m[0] ** 2) / (2.0 * 2.0**2)) == pytest.approx(0.68)


def test_several_talkers_tell_the_same_moments() -> None:
    track = read_track(log(rmc("120000"), gga("120000", "GN"), rmc("120000", talker="GL"), rmc("120001")))
    assert len(track) == 2


def test_vtg_brings_course_and_speed_where_rmc_has_none() -> None:
    track = read_track(log(gga("120000"), "GPVTG,054.7,T,034.4,M,005.5,N,010.2,K"))
    assert track.bearing_deg is not None
    assert track.speed_mps is not None
    assert track.bearing_deg[0] == 54.7
    assert track.speed_mps[0] == pytest.approx(10.2 / 3.6)


def test_midnight_is_passed_between_two_dates() -> None:
    track = read_track(log(gga("235958"), rmc("235959"), gga("000000"), gga("000001")))
    np.testing.assert_array_equal((track.time - track.time[1]) / np.timedelta64(1, "s"), [-1, 0, 1, 2])


def test_times_without_any_date_are_seconds_that_go_on_past_midnight() -> None:
    track = read_track(log(gga("235959"), gga("000001")))
    assert track.time.tolist() == [86399.0, 86401.0]


def test_a_sentence_with_a_wrong_checksum_is_left_out_and_counted() -> None:
    track = read_track(log(rmc("120000")) + b"\r\n" + log(rmc("120001")).replace(b"*", b"*F") + b"\r\n")
    assert (len(track), track.left_out) == (1, 1)


def test_a_moment_without_a_fix_stays_as_a_row() -> None:
    track = read_track(log(rmc("120000"), rmc("120001", status="V"), gga("120001", quality=0)))
    assert track.fault.tolist() == [RowFault.none, RowFault.position_missing]


def test_a_position_that_is_no_number_is_told() -> None:
    track = read_track(log(rmc("120000"), rmc("120001").replace("4807.038", "48x7.038")))
    assert track.fault.tolist() == [RowFault.none, RowFault.position_unreadable]


def test_a_log_of_damaged_sentences_says_so() -> None:
    with pytest.raises(InputError, match="1 sentences have a wrong checksum"):
        read_track(log(rmc("120000")).replace(b"N", b"S", 1))
