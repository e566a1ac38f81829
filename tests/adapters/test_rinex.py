import gzip
from pathlib import Path

import numpy as np
import pytest
import sidereon
from hypothesis import given, settings
from hypothesis import strategies as st

from estimators.adapters import rinex
from estimators.arrays import InputError
from estimators.gnss.observed_epochs import ObservedEpochs
from estimators.gnss.options import PositionOptions
from estimators.gnss.snapshot.solved import solve_epochs
from tests.gnss.recorded import read_recorded

FILES = {
    "esbc": (
        "esbc_2020_177/ESBC00DNK_20201770000_120S.rnx.gz",
        "esbc_2020_177/ESBC00DNK_R_20201770000_01D_MN.rnx.gz",
    ),
    "kamakura": ("kamakura_2021_078/SEPT078M.21O.gz", "kamakura_2021_078/SEPT078M.21P"),
}


def read(folder: Path, station: str, **options) -> ObservedEpochs:
    observations, navigation = FILES[station]
    return rinex.read_rinex(folder / observations, folder / navigation, **options)


@pytest.fixture(scope="module")
def esbc(gnss_data: Path) -> ObservedEpochs:
    return read(gnss_data, "esbc")


@pytest.fixture(scope="module")
def navigation(gnss_data: Path) -> bytes:
    return (gnss_data / FILES["kamakura"][1]).read_bytes()


@pytest.fixture(scope="module")
def minute(gnss_data: Path) -> str:
    """The first three epochs of the recording at Kamakura."""
    lines = (
        gzip.decompress((gnss_data / FILES["kamakura"][0]).read_bytes()).decode().splitlines(keepends=True)
    )
    epochs = [k for k, line in enumerate(lines) if line.startswith(">")]
    return "".join(lines[: epochs[3]])


@pytest.mark.parametrize("station", ["esbc", "kamakura"])
def test_satellites_and_ranges_but_for_the_troposphere_are_those_of_rtklib(
    gnss_data: Path, station: str
) -> None:
    table, observed = read_recorded(gnss_data, station), read(gnss_data, station)
    epoch = np.repeat(np.arange(len(observed)), np.diff(observed.table.offsets))
    row = {
        (observed.time_gps[e], name): i
        for i, (e, name) in enumerate(zip(epoch, observed.table.names, strict=True))
    }
    times = np.repeat(table.time_gps, np.diff(table.offsets)).astype("datetime64[ns]")
    pairs = [(k, row[key]) for k, key in enumerate(zip(times, table.satellite, strict=True))]
    theirs, ours = (np.array(column) for column in zip(*pairs, strict=True))
    far = np.linalg.norm(table.positions[theirs] - observed.table.satellites_m[ours], axis=1)
    without_troposphere = (table.columns["corr_pr_m"] + table.columns["tropo_m"])[theirs]
    off = np.abs(without_troposphere - (observed.table.pseudoranges_m + observed.troposphere_m)[ours])
    galileo = np.array([name[0] == "E" for name in table.satellite])[theirs]
    assert far[~galileo].max() < 0.001
    assert off[~galileo].max() < 0.01
    # RTKLIB takes messages of the past alone, and the group delay from the first in the file, F/NAV or not.
    assert far[galileo].max() < 1.5
    assert np.quantile(off[galileo], 0.9) < 2.0


@pytest.mark.parametrize(
    ("systems", "median_m", "most_m"), [("G", 0.7, 2.3), ("GREC", 0.65, 1.5)], ids=["gps", "four systems"]
)
def test_positions_of_a_day_are_as_good_as_rtklibs(
    gnss_data: Path, systems: str, median_m: float, most_m: float
) -> None:
    observed = read(gnss_data, "esbc", systems=list(systems))
    solved = solve_epochs(observed.table, PositionOptions())
    truth = read_recorded(gnss_data, "esbc").truth
    up = truth / np.linalg.norm(truth)
    error = solved.state[:, :3] - truth
    horizontal = np.linalg.norm(error - np.outer(error @ up, up), axis=1)
    assert not solved.excluded.any()
    assert np.median(horizontal) < median_m
    assert np.quantile(horizontal, 0.95) < most_m


def test_two_codes_leave_no_ionosphere(gnss_data: Path) -> None:
    observed = read(gnss_data, "esbc", systems=["G", "E"], ionosphere="dual")
    solved = solve_epochs(observed.table, PositionOptions())
    error = np.linalg.norm(solved.state[:, :3] - read_recorded(gnss_data, "esbc").truth, axis=1)
    assert observed.ionosphere == "dual"
    assert not observed.ionosphere_m.any()
    assert np.median(error) < 3.0


def test_range_rates_are_those_of_the_moving_satellites(esbc: ObservedEpochs, gnss_data: Path) -> None:
    truth = read_recorded(gnss_data, "esbc").truth
    sight = esbc.table.satellites_m - truth
    sight /= np.linalg.norm(sight, axis=1)[:, None]
    left = esbc.range_rate_mps - np.einsum("ij,ij->i", sight, esbc.velocities_mps)
    epoch = np.repeat(np.arange(len(esbc)), np.diff(esbc.table.offsets))
    drift = np.array([np.nanmedian(left[epoch == k]) for k in range(50)])
    first = epoch < 50
    assert np.nanquantile(np.abs(left[first] - drift[epoch[first]]), 0.95) < 0.3


def test_times_are_gps_time_and_utc(esbc: ObservedEpochs) -> None:
    assert len(esbc) == 720
    assert esbc.time_gps[0] == np.datetime64("2020-06-25T00:00:00")
    assert esbc.time_utc[0] == np.datetime64("2020-06-24T23:59:42")


def test_only_the_systems_asked_for_are_read(gnss_data: Path) -> None:
    observed = read(gnss_data, "kamakura", systems=["Galileo", "J"])
    assert {name[0] for name in observed.table.names} == {"E", "J"}


@pytest.mark.parametrize("packed", ["plain", "gzip", "hatanaka", "hatanaka, gzip", "rinex 2"])
def test_a_file_reads_the_same_however_it_is_packed(minute: str, navigation: bytes, packed: str) -> None:
    forms = {
        "plain": minute.encode,
        "gzip": lambda: gzip.compress(minute.encode()),
        "hatanaka": lambda: sidereon.encode_crinex(minute).encode(),
        "hatanaka, gzip": lambda: gzip.compress(sidereon.encode_crinex(minute).encode()),
        "rinex 2": lambda: (
            sidereon.parse_rinex_obs(minute).downgrade_to_rinex2(2.11)[0].to_rinex_string().encode()
        ),
    }
    expected = rinex.read_rinex(minute.encode(), navigation, systems=["G"])
    observed = rinex.read_rinex(forms[packed](), gzip.compress(navigation), systems=["G"])
    order = [
        np.lexsort((o.table.names, np.repeat(np.arange(3), np.diff(o.table.offsets))))
        for o in (expected, observed)
    ]
    assert sorted(expected.table.names) == sorted(observed.table.names)
    assert np.array_equal(expected.table.pseudoranges_m[order[0]], observed.table.pseudoranges_m[order[1]])


def test_navigation_records_are_those_that_sidereon_reads(navigation: bytes) -> None:
    ephemerides = rinex.read_navigation(navigation).ephemerides
    theirs = {}
    for record in sidereon.parse_rinex_nav_records(navigation.decode()):
        if record.message.label != "galileo_fnav":
            theirs[record.satellite, round(record.toe_tow_s)] = record.elements.sqrt_a
    ours = {}
    for j, name in enumerate(ephemerides.names):
        for row in range(ephemerides.starts[j], ephemerides.starts[j + 1]):
            ours[name, round(ephemerides.elements[row, 15])] = ephemerides.elements[row, 0]
    assert ours == {key: value for key, value in theirs.items() if key[0][0] in "GECJ"}


def test_navigation_files_are_taken_together(gnss_data: Path, minute: str, navigation: bytes) -> None:
    other = gnss_data / FILES["esbc"][1]
    alone = rinex.read_rinex(minute.encode(), navigation)
    together = rinex.read_rinex(minute.encode(), [navigation, other])
    assert np.array_equal(alone.table.pseudoranges_m, together.table.pseudoranges_m)


def test_without_coefficients_the_ionosphere_stays_and_widens_the_noise(
    minute: str, navigation: bytes
) -> None:
    bare = b"\n".join(line for line in navigation.split(b"\n") if b"IONOSPHERIC CORR" not in line)
    known, unknown = (rinex.read_rinex(minute.encode(), nav) for nav in (navigation, bare))
    assert (known.ionosphere, unknown.ionosphere) == ("klobuchar", "none")
    assert unknown.table.sigma_m.min() > 5.0 > known.table.sigma_m.max()
    with pytest.raises(InputError, match="no ionosphere coefficients"):
        rinex.read_rinex(minute.encode(), bare, ionosphere="broadcast")


def test_the_wrong_day_is_refused_with_both_dates(gnss_data: Path, minute: str) -> None:
    with pytest.raises(InputError, match=r"2021-03-19T12:00.*2020-06-2") as refused:
        rinex.read_rinex(minute.encode(), gnss_data / FILES["esbc"][1])
    assert refused.value.field == "navigation"


@pytest.mark.parametrize(
    ("observations", "reason"),
    [
        (b"", "is empty"),
        (b"hello", "RINEX VERSION / TYPE"),
        (b"\x1f\x8b\x08broken", "damaged|too early"),
        (b"\x1f\x9d\x90", "unpack it"),
        (b"\x00" * 100, "no text"),
        (Path("no/such/file"), "cannot be read"),
    ],
)
def test_what_is_no_observation_file_is_refused(
    observations: bytes | Path, reason: str, navigation: bytes
) -> None:
    with pytest.raises(InputError, match=reason) as refused:
        rinex.read_rinex(observations, navigation)
    assert refused.value.field == "observations"


def test_files_in_each_others_place_are_refused(minute: str, navigation: bytes) -> None:
    with pytest.raises(InputError, match="send the navigation file here"):
        rinex.read_rinex(minute.encode(), minute.encode())
    with pytest.raises(InputError, match="send the observation file here"):
        rinex.read_rinex(navigation, navigation)


def test_a_header_without_epochs_is_refused(minute: str, navigation: bytes) -> None:
    with pytest.raises(InputError, match=r"no epoch|cannot be read"):
        rinex.read_rinex(minute[: minute.index(">")].encode(), navigation)


def test_a_navigation_header_alone_is_refused(minute: str, navigation: bytes) -> None:
    header = navigation[: navigation.index(b"END OF HEADER") + 14]
    with pytest.raises(InputError, match="no usable ephemeris"):
        rinex.read_rinex(minute.encode(), header)


def test_epochs_that_go_back_in_time_are_refused(minute: str, navigation: bytes) -> None:
    body = minute.index(">")
    with pytest.raises(InputError, match="sort it by time"):
        rinex.read_rinex((minute + minute[body:]).encode(), navigation)


@pytest.mark.parametrize("pack", [gzip.compress, lambda text: sidereon.encode_crinex(text.decode()).encode()])
def test_a_file_that_unpacks_to_too_much_is_refused(minute: str, navigation: bytes, pack) -> None:
    with pytest.raises(InputError, match="split it by time"):
        rinex.read_rinex(pack(minute.encode()), navigation, most_bytes=len(minute) // 2)


def test_reading_ends_with_what_the_check_raises(minute: str, navigation: bytes) -> None:
    def leave() -> None:
        raise TimeoutError

    with pytest.raises(TimeoutError):
        rinex.read_rinex(minute.encode(), navigation, check=leave)


def test_navigation_files_that_unpack_to_too_much_together_are_refused(
    minute: str, navigation: bytes
) -> None:
    room = max(len(minute), len(navigation)) + 1
    rinex.read_rinex(minute.encode(), navigation, most_bytes=room)
    with pytest.raises(InputError, match="split it by time") as refused:
        rinex.read_rinex(minute.encode(), [navigation, navigation], most_bytes=room)
    assert refused.value.field == "navigation"


@settings(deadline=None, max_examples=60)
@given(data=st.data())
def test_a_damaged_file_is_read_or_refused_and_nothing_else(minute: str, navigation: bytes, data) -> None:
    observations = minute.encode()
    damaged = [bytearray(observations), bytearray(navigation)]
    for text in damaged:
        for _ in range(data.draw(st.integers(0, 4))):
            at = data.draw(st.integers(0, max(0, len(text) - 1)))
            text[at : at + data.draw(st.sampled_from([0, 1, 80, 3000]))] = data.draw(
                st.sampled_from(
                    [b"", b"9", b"-", b"\n", b"1e308", b"\xb2", b"> 2021 13 40 25 61 61.0  0 99\n"]
                )
            )
    try:
        observed = rinex.read_rinex(bytes(damaged[0]), bytes(damaged[1]))
    except InputError as refused:
        field = refused.field
    else:
        field = "none"
        assert np.isfinite(observed.table.pseudoranges_m).all()
        assert np.isfinite(observed.table.satellites_m).all()
    assert field in {"observations", "navigation", "none"}
