import gzip
from pathlib import Path

import numpy as np
import pytest

from estimators.adapters.gnss_logger import read_gnss_logger
from estimators.arrays import InputError
from estimators.geodesy.ellipsoid import to_cartesian
from estimators.geodesy.local_frame import enu_axes
from estimators.gnss.observed_epochs import ObservedEpochs
from estimators.gnss.options import PositionOptions
from estimators.gnss.snapshot.solved import solve_epochs

PARK = (37.422578, -122.081678, -28.0)


@pytest.fixture(scope="module")
def folder(gnss_data: Path) -> Path:
    return gnss_data / "google_2016_06_30"


@pytest.fixture(scope="module")
def log(folder: Path) -> list[str]:
    packed = (folder / "pseudoranges_log_2016_06_30_21_26_07.txt.gz").read_bytes()
    return gzip.decompress(packed).decode().splitlines()


@pytest.fixture(scope="module")
def navigation(folder: Path) -> bytes:
    return (folder / "hour1820.16n").read_bytes()


@pytest.fixture(scope="module")
def observed(log: list[str], navigation: bytes) -> ObservedEpochs:
    return read_gnss_logger("\n".join(log).encode(), navigation)


def first_epochs(log: list[str]) -> list[str]:
    return log[:60]


def changed(log: list[str], name: str, value: str) -> bytes:
    """The log with one column of all measurements replaced."""
    header = next(line for line in log if line.startswith("# Raw,"))
    place = [cell.strip() for cell in header[2:].split(",")].index(name)
    lines = []
    for line in first_epochs(log):
        cells = line.split(",")
        if cells[0] == "Raw":
            cells[place] = value
        lines.append(",".join(cells))
    return "\n".join(lines).encode()


def test_a_phone_in_the_park_is_found_within_metres(observed: ObservedEpochs) -> None:
    solved = solve_epochs(observed.table, PositionOptions())
    error = (solved.state[:, :3] - to_cartesian(np.array(PARK))) @ enu_axes(*PARK[:2]).T
    assert np.abs(np.median(error[:, :2], axis=0)).max() < 5.0
    assert np.median(np.hypot(error[:, 0], error[:, 1])) < 12.0


def test_every_reading_of_the_clock_is_an_epoch(observed: ObservedEpochs, log: list[str]) -> None:
    readings = {line.split(",")[2] for line in log if line.startswith("Raw,")}
    assert len(observed) == len(readings)
    assert str(observed.time_gps[0])[:19] == "2016-06-30T21:26:25"
    assert str(observed.time_utc[0])[:19] == "2016-06-30T21:26:08"


def test_range_rates_are_those_of_the_moving_satellites(observed: ObservedEpochs) -> None:
    sight = observed.table.satellites_m - to_cartesian(np.array(PARK))
    sight /= np.linalg.norm(sight, axis=1)[:, None]
    left = observed.range_rate_mps - np.einsum("ij,ij->i", sight, observed.velocities_mps)
    epoch = np.repeat(np.arange(len(observed)), np.diff(observed.table.offsets))
    drift = np.array([np.median(left[epoch == k]) for k in range(len(observed))])
    assert np.std(left - drift[epoch]) < 0.3


def test_signal_strength_weighs_by_default(observed: ObservedEpochs) -> None:
    strong, weak = observed.cn0_dbhz > 38.0, observed.cn0_dbhz < 28.0
    assert observed.table.sigma_m[strong].max() < observed.table.sigma_m[weak].min()


@pytest.mark.parametrize(
    ("column", "value"),
    [
        ("State", "1"),
        ("State", "8"),
        ("ReceivedSvTimeUncertaintyNanos", "900"),
        ("ConstellationType", "2"),
        ("FullBiasNanos", ""),
        ("Svid", "99"),
        ("ReceivedSvTimeNanos", "garbage"),
        ("CarrierFrequencyHz", "1176450000"),
    ],
)
def test_measurements_that_cannot_be_trusted_take_no_part(
    log: list[str], navigation: bytes, column: str, value: str
) -> None:
    with pytest.raises(InputError, match="no measurement") as refused:
        read_gnss_logger(changed(log, column, value), navigation)
    assert refused.value.field == "log"


def test_a_known_time_of_week_counts_like_a_decoded_one(log: list[str], navigation: bytes) -> None:
    known = read_gnss_logger(changed(log, "State", str(1 | 1 << 14)), navigation)
    decoded = read_gnss_logger("\n".join(first_epochs(log)).encode(), navigation)
    assert np.array_equal(known.table.pseudoranges_m, decoded.table.pseudoranges_m)


def test_the_week_may_turn_between_transmission_and_reception(log: list[str], navigation: bytes) -> None:
    week = 604800 * 10**9
    lines = []
    header = next(line for line in log if line.startswith("# Raw,"))
    place = [cell.strip() for cell in header[2:].split(",")].index("ReceivedSvTimeNanos")
    for line in first_epochs(log):
        cells = line.split(",")
        if cells[0] == "Raw":
            cells[place] = str(int(cells[place]) - week)
        lines.append(",".join(cells))
    turned = read_gnss_logger("\n".join(lines).encode(), navigation)
    plain = read_gnss_logger("\n".join(first_epochs(log)).encode(), navigation)
    assert np.array_equal(turned.table.pseudoranges_m, plain.table.pseudoranges_m)


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (b"", "is empty"),
        (b"Fix,gps,37.4,-122.1", "no header"),
        (b"# Raw,TimeNanos,Svid\nRaw,1,2", "lacks the columns FullBiasNanos"),
        (b"\x1f\x8b\x08", "too early|damaged"),
    ],
)
def test_what_is_no_log_is_refused(content: bytes, reason: str, navigation: bytes) -> None:
    with pytest.raises(InputError, match=reason) as refused:
        read_gnss_logger(content, navigation)
    assert refused.value.field == "log"


def test_navigation_of_another_day_is_refused(log: list[str], gnss_data: Path) -> None:
    with pytest.raises(InputError, match="serves none of the observations") as refused:
        read_gnss_logger(
            "\n".join(first_epochs(log)).encode(), gnss_data / "kamakura_2021_078" / "SEPT078M.21P"
        )
    assert refused.value.field == "navigation"


def test_reading_ends_with_what_the_check_raises(log: list[str], navigation: bytes) -> None:
    def leave() -> None:
        raise TimeoutError

    with pytest.raises(TimeoutError):
        read_gnss_logger("\n".join(first_epochs(log)).encode(), navigation, check=leave)


def test_one_code_per_satellite_is_read_of_a_phone(log: list[str], navigation: bytes) -> None:
    with pytest.raises(InputError, match="one code per satellite"):
        read_gnss_logger("\n".join(first_epochs(log)).encode(), navigation, ionosphere="dual")
