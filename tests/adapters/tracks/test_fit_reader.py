import numpy as np
import pytest

from estimators.adapters.tracks import RowFault, read_track
from estimators.arrays import InputError
from tests.adapters.tracks.fit_files import EPOCH_S, activity, data, definition, fit_file, semicircles

FIX = {253: "I", 0: "i", 1: "i"}


def fix(second: int, lat: float = 52.5, order: str = "<") -> bytes:
    return data(0, order + "Iii", 1_000_000_000 + second, semicircles(lat), semicircles(13.4))


def test_a_fit_activity_gives_times_positions_and_what_the_watch_measured() -> None:
    track = read_track(activity())
    assert track.form == "fit"
    assert track.time[0] == np.datetime64(EPOCH_S + 1_000_000_000, "s")
    np.testing.assert_allclose(track.lat, 52.5 + 1e-5 * np.arange(5), atol=1e-7)
    assert track.height_m is not None
    assert track.speed_mps is not None
    assert track.accuracy_m is not None
    assert (track.height_m[0], track.speed_mps[0], track.accuracy_m[0]) == (34.0, 4.2, 6.0)


def test_big_endian_messages_are_read_as_well() -> None:
    track = read_track(fit_file(definition(0, 20, FIX, order=">"), fix(7, order=">")))
    assert track.time[0] == np.datetime64(EPOCH_S + 1_000_000_007, "s")
    assert track.lat[0] == pytest.approx(52.5, abs=1e-7)


def test_compressed_timestamps_count_on_from_the_last_full_one() -> None:
    short = definition(1, 20, {0: "i", 1: "i"})
    # 1,000,000,000 has 0 in its lower five bits, so 30 is 30 s later and a following 1 is 33 s later.
    compressed = [
        bytes([0x80 | 1 << 5 | bits]) + data(0, "<ii", semicircles(50.0), semicircles(7.0))[1:]
        for bits in (30, 1)
    ]
    track = read_track(fit_file(definition(0, 20, FIX), fix(0), short, *compressed))
    np.testing.assert_array_equal((track.time - track.time[0]) / np.timedelta64(1, "s"), [0, 30, 33])


def test_a_stopped_timer_begins_a_new_segment() -> None:
    event = definition(1, 21, {253: "I", 0: "B", 1: "B"})
    stop = data(1, "<IBB", 1_000_000_001, 0, 4)
    track = read_track(fit_file(definition(0, 20, FIX), event, fix(0), fix(1), stop, fix(60)))
    assert track.segment is not None
    assert track.segment.tolist() == [0, 0, 1]


def test_the_zone_of_the_watch_is_kept() -> None:
    zone = definition(1, 34, {253: "I", 5: "I"})
    ended = data(1, "<II", 1_000_000_000, 1_000_000_000 + 9 * 3600)
    track = read_track(fit_file(definition(0, 20, FIX), fix(0), zone, ended))
    assert track.utc_offset_minutes is not None
    assert track.utc_offset_minutes.tolist() == [540]


def test_developer_fields_are_stepped_over() -> None:
    body = fit_file(definition(0, 20, FIX, developer=3), fix(0) + b"xyz", fix(1) + b"xyz")
    assert len(read_track(body)) == 2


def test_a_record_without_position_stays_as_a_row() -> None:
    track = read_track(
        fit_file(definition(0, 20, FIX), fix(0), data(0, "<Iii", 1_000_000_001, 0x7FFFFFFF, 0x7FFFFFFF))
    )
    assert track.fault.tolist() == [RowFault.none, RowFault.position_missing]


def test_chained_files_are_read_one_after_the_other() -> None:
    assert len(read_track(activity(3) + activity(2))) == 5


def test_a_changed_byte_is_noticed_by_the_checksum() -> None:
    body = bytearray(activity())
    body[40] ^= 1
    with pytest.raises(InputError, match="checksum is wrong"):
        read_track(bytes(body))


def test_a_cut_fit_file_is_said_to_end_too_early() -> None:
    with pytest.raises(InputError, match="ends too early"):
        read_track(activity()[:-9])


def test_a_fit_file_of_settings_is_no_track() -> None:
    with pytest.raises(InputError, match="without records"):
        read_track(fit_file(definition(0, 2, {0: "B"}), data(0, "<B", 1)))
