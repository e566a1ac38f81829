"""RINEX files and phones' logs by upload, to a real server; files are recorded ones or cut from them."""

from __future__ import annotations

import gzip
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx2
import pytest
import sidereon

from service.errors import ProblemType
from service.schemas.fixes import FeatureCollectionAnswer, PositionAnswer, PositionsAnswer
from tests.service.conftest import MakeClient
from tests.service.problems import refused
from tests.service.server import Server, serve

BODY_LIMIT = 400_000


@pytest.fixture(scope="module")
def server() -> Iterator[Server]:
    with serve(max_body_bytes=BODY_LIMIT, max_points=2_000) as running:
        yield running


@pytest.fixture(scope="module")
def folder(gnss_data: Path) -> Path:
    return gnss_data / "kamakura_2021_078"


@pytest.fixture(scope="module")
def epochs(folder: Path) -> str:
    """The header and the first three epochs of a recorded file."""
    text = gzip.decompress((folder / "SEPT078M.21O.gz").read_bytes()).decode()
    return ">".join(text.split(">")[:4])


@pytest.fixture(scope="module")
def navigation(folder: Path) -> bytes:
    return gzip.compress((folder / "SEPT078M.21P").read_bytes())


@pytest.fixture(scope="module")
def phone(gnss_data: Path) -> tuple[bytes, bytes]:
    where = gnss_data / "google_2016_06_30"
    log = gzip.decompress((where / "pseudoranges_log_2016_06_30_21_26_07.txt.gz").read_bytes())
    return b"\n".join(log.splitlines()[:120]), gzip.compress((where / "hour1820.16n").read_bytes())


def upload(server: Server, *parts: tuple[str, bytes], **params: Any) -> httpx2.Response:
    files = [(name, (f"{name}.file", content)) for name, content in parts]
    return httpx2.post(f"{server.url}/v1/positions", files=files, params=params, timeout=60)


def test_a_recorded_file_is_located_with_its_navigation_file(
    server: Server, epochs: str, navigation: bytes
) -> None:
    answer = upload(server, ("observations", epochs.encode()), ("navigation", navigation)).json()
    PositionsAnswer.model_validate(answer)
    assert answer["fixes"]["time"][0] == "2021-03-19T11:59:42Z"
    assert answer["fixes"]["lat_deg"] == pytest.approx([35.34] * 3, abs=0.05)
    assert set(answer["left_out"]["reason"]) <= {"masked", "missing", "no_ephemeris", "unhealthy"}


@pytest.mark.parametrize("packed", ["gzip", "hatanaka", "hatanaka, gzip", "rinex 2"])
def test_a_file_is_answered_the_same_however_it_is_packed(
    server: Server, epochs: str, navigation: bytes, packed: str
) -> None:
    forms = {
        "gzip": lambda: gzip.compress(epochs.encode()),
        "hatanaka": lambda: sidereon.encode_crinex(epochs).encode(),
        "hatanaka, gzip": lambda: gzip.compress(sidereon.encode_crinex(epochs).encode()),
        "rinex 2": lambda: (
            sidereon.parse_rinex_obs(epochs).downgrade_to_rinex2(2.11)[0].to_rinex_string().encode()
        ),
    }
    plain = upload(server, ("observations", epochs.encode()), ("navigation", navigation), systems="G")
    other = upload(server, ("observations", forms[packed]()), ("navigation", navigation), systems="G")
    assert other.json()["fixes"]["position_ecef_m"] == [
        pytest.approx(row, abs=1e-6) for row in plain.json()["fixes"]["position_ecef_m"]
    ]


def test_a_phone_log_is_told_by_its_content(server: Server, phone: tuple[bytes, bytes]) -> None:
    log, navigation = phone
    response = upload(server, ("observations", log), ("navigation", navigation), format="geojson")
    answer = response.json()
    FeatureCollectionAnswer.model_validate(answer)
    longitude, latitude, _ = answer["features"][0]["geometry"]["coordinates"]
    assert (longitude, latitude) == pytest.approx((-122.08, 37.42), abs=0.05)


def test_the_one_epoch_of_a_file_is_a_single_epoch(server: Server, epochs: str, navigation: bytes) -> None:
    one = ">".join(epochs.split(">")[:2]).encode()
    answer = upload(server, ("observations", one), ("navigation", navigation)).json()
    PositionAnswer.model_validate(answer)
    assert answer["time"] == "2021-03-19T11:59:42Z"
    sky = upload(server, ("observations", one), ("navigation", navigation), format="svg")
    assert sky.headers["content-type"] == "image/svg+xml"


def test_several_navigation_files_are_taken_together(server: Server, epochs: str, navigation: bytes) -> None:
    part = ("observations", epochs.encode())
    once = upload(server, part, ("navigation", navigation))
    twice = upload(server, part, ("navigation", navigation), ("navigation", navigation))
    assert twice.content == once.content


def test_arguments_come_in_the_query(server: Server, epochs: str, navigation: bytes) -> None:
    parts = ("observations", epochs.encode()), ("navigation", navigation)
    asked = {"systems": "G,Galileo", "method": "raim", "options.elevation_mask_deg": 25}
    answer = upload(server, *parts, **asked).json()
    assert set(answer["satellites"]["system"]) == {"G", "E"}
    assert answer["method"] == "raim"
    wide = upload(server, *parts, systems="G,E").json()
    assert len(wide["satellites"]["row"]) > len(answer["satellites"]["row"])
    # `rotated` is about satellite positions, and these are computed here.
    refused(upload(server, *parts, rotated=True), ProblemType.unknown_field, "rotated")


@pytest.mark.parametrize(
    ("names", "field"),
    [
        (["observations"], "navigation"),
        (["navigation"], "observations"),
        (["observations", "observations", "navigation"], "observations"),
        (["observations", "navigation", "orbits"], "orbits"),
    ],
)
def test_parts_that_are_missing_or_too_many_are_named(
    server: Server, epochs: str, navigation: bytes, names: list[str], field: str
) -> None:
    contents = {"observations": epochs.encode(), "navigation": navigation, "orbits": b"*"}
    refused(upload(server, *((name, contents[name]) for name in names)), ProblemType.invalid_value, field)


def test_more_parts_than_are_taken_are_refused(server: Server) -> None:
    refused(upload(server, *[("navigation", b"x")] * 65), ProblemType.invalid_value, "body")


@pytest.mark.parametrize(
    ("observations", "word"),
    [
        (b"hello", "RINEX VERSION"),
        (b"\x1f\x8b\x08broken", "gzip"),
        (b"# Raw,TimeNanos\nRaw,1", "lacks the columns"),
        (b"\x00\x01" * 50, "no text"),
        (b" ", "empty"),
    ],
)
def test_garbage_is_refused_as_the_part_that_it_is(
    server: Server, navigation: bytes, observations: bytes, word: str
) -> None:
    response = upload(server, ("observations", observations), ("navigation", navigation))
    assert word in refused(response, ProblemType.invalid_value, "observations")["detail"]


def test_files_in_each_others_place_are_refused(server: Server, epochs: str, navigation: bytes) -> None:
    swapped = upload(server, ("observations", navigation), ("navigation", epochs.encode()))
    assert (
        "send the navigation file here" in refused(swapped, ProblemType.invalid_value, "navigation")["detail"]
    )
    twice = upload(server, ("observations", navigation), ("navigation", navigation))
    assert (
        "send the observation file here"
        in refused(twice, ProblemType.invalid_value, "observations")["detail"]
    )


def test_a_navigation_file_of_another_day_is_refused_with_both_dates(
    server: Server, epochs: str, phone: tuple[bytes, bytes]
) -> None:
    response = upload(server, ("observations", epochs.encode()), ("navigation", phone[1]))
    detail = refused(response, ProblemType.invalid_value, "navigation")["detail"]
    assert "2021-03-19" in detail
    assert "2016-06-30" in detail


def test_a_file_cut_off_in_its_header_is_refused(server: Server, epochs: str, navigation: bytes) -> None:
    cut = epochs[: epochs.index("END OF HEADER")].encode()
    refused(
        upload(server, ("observations", cut), ("navigation", navigation)),
        ProblemType.invalid_value,
        "observations",
    )


def test_a_time_system_that_is_not_known_is_refused(server: Server, epochs: str, navigation: bytes) -> None:
    lines = epochs.split("\n")
    place = next(k for k, line in enumerate(lines) if "TIME OF FIRST OBS" in line)
    lines[place] = lines[place].replace("GPS", "IRN")
    response = upload(server, ("observations", "\n".join(lines).encode()), ("navigation", navigation))
    assert response.status_code == 422
    assert response.json()["field"] == "observations"


def test_a_file_that_unpacks_to_too_much_is_refused(server: Server, epochs: str, navigation: bytes) -> None:
    header, body = epochs[: epochs.index(">")], epochs[epochs.index(">") :]
    bomb = gzip.compress((header + body * (5 * BODY_LIMIT // len(body))).encode())
    assert len(bomb) < BODY_LIMIT // 4
    response = upload(server, ("observations", bomb), ("navigation", navigation))
    assert "unpacks to more" in refused(response, ProblemType.invalid_value, "observations")["detail"]
    response = upload(server, ("observations", epochs.encode()), ("navigation", bomb))
    assert "unpacks to more" in refused(response, ProblemType.invalid_value, "navigation")["detail"]


def test_more_ranges_than_the_limit_are_refused(server: Server, folder: Path, navigation: bytes) -> None:
    text = gzip.decompress((folder / "SEPT078M.21O.gz").read_bytes()).decode()
    many = gzip.compress(">".join(text.split(">")[:120]).encode())
    response = upload(server, ("observations", many), ("navigation", navigation))
    refused(response, ProblemType.too_many_points, None)


def test_an_upload_above_the_limit_of_bodies_is_refused(server: Server, navigation: bytes) -> None:
    large = b"x" * (BODY_LIMIT + 1)
    response = upload(server, ("observations", large), ("navigation", navigation))
    refused(response, ProblemType.body_too_large, None)


@pytest.mark.parametrize(
    ("content_type", "body"),
    [
        ("multipart/form-data", b"--b\r\n\r\n--b--"),
        ("multipart/form-data; boundary=b", b"hello"),
        ("multipart/form-data; boundary=b", b'--b\r\nContent-Disposition: form-data; name="x"\r\n\r\ncut'),
        ("multipart/form-data; boundary=" + "b" * 300, b"--b--"),
    ],
)
def test_a_body_whose_parts_cannot_be_told_apart_is_refused(
    server: Server, content_type: str, body: bytes
) -> None:
    response = httpx2.post(f"{server.url}/v1/positions", content=body, headers={"content-type": content_type})
    refused(response, ProblemType.malformed_body, None)


def test_a_file_without_enough_satellites_gives_the_reason(
    server: Server, epochs: str, navigation: bytes
) -> None:
    response = upload(
        server,
        ("observations", epochs.encode()),
        ("navigation", navigation),
        **{"options.elevation_mask_deg": 80},
    )
    refused(response, ProblemType.no_position, "observations")
    assert response.json()["reason"] == "too_few_satellites"


def test_without_the_extra_for_rinex_the_problem_names_it(
    server: Server, epochs: str, navigation: bytes, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in [name for name in sys.modules if name.startswith("estimators.adapters.rinex")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "sidereon", None)
    response = upload(server, ("observations", epochs.encode()), ("navigation", navigation))
    assert "[rinex]" in refused(response, ProblemType.not_installed, None)["detail"]


def test_a_file_that_takes_longer_than_the_deadline_is_a_problem(
    folder: Path, navigation: bytes, make_client: MakeClient
) -> None:
    client = make_client(deadline_seconds=0.02)
    packed = (folder / "SEPT078M.21O.gz").read_bytes()
    files = [("observations", ("o", packed)), ("navigation", ("n", navigation))]
    response = client.post("/v1/positions", files=files)
    assert response.json()["type"] == ProblemType.deadline_exceeded.uri
