"""What ``plumbline clean`` writes piece by piece is what it writes of the whole."""

from __future__ import annotations

import io
import os
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from typer.testing import CliRunner, Result

from estimators.adapters.tracks import cleaning, spool
from service.cli import app
from service.codecs.limits import Limits
from service.codecs.trajectories.registry import WRITERS
from service.schemas.trajectories import TrackAnswerQuery, TrackArguments
from service.trajectories.cleaned import clean_recorded
from service.trajectories.files import read_files
from service.trajectories.recorded import of_files
from tests.service.fixes import N, as_csv, as_gpx, clock, two_walks, walk

Fields = dict[str, Any]


def one() -> Fields:
    return walk()


def shuffled(fields: Fields, seed: int = 3) -> Fields:
    order = np.random.default_rng(seed).permutation(len(fields["time"]))
    return {name: [column[row] for row in order] for name, column in fields.items()}


def two_in_disorder() -> Fields:
    """Two devices with times of a zone, heights of one of them, no time or place here and there."""
    fields = two_walks()
    fields["time"] = [moment for moment in clock() for _ in range(2)]
    fields["height"] = [500.0 + row % 5 if row % 2 else None for row in range(2 * N)]
    fields["time"][17], fields["lat"][30], fields["lat"][41] = None, None, 95.0
    return shuffled(fields)


def fleet_on_end() -> Fields:
    """Devices one after the other, of which one has no track, and one no name."""
    fields = two_walks()
    order = np.argsort(fields["device"], kind="stable")
    told = {name: [column[row] for row in order] for name, column in fields.items()}
    still = {"time": [7, 7], "lat": [1.0, 2.0], "lon": [3.0, 4.0], "device": ["parked", "parked"]}
    nameless = walk(40, 13.0) | {"device": [None] * 40}
    return {name: told[name] + still[name] + nameless[name] for name in told}


def zones_that_differ() -> Fields:
    return walk(time=[*clock()[: N // 2], *clock(zone="-03:30")[N // 2 :]])


def segments_that_come_back() -> Fields:
    return walk(time=clock(), trip=[row // 10 % 2 for row in range(N)])


def with_speeds() -> Fields:
    """Speeds and courses that help, told to a tenth of a degree."""
    random = np.random.default_rng(5)
    speed, bearing = 11.1 + 0.1 * random.normal(size=N), np.round(random.normal(size=N), 1) % 360.0
    return walk(speed=speed.tolist(), bearing=bearing.tolist(), accuracy=[4.0 + row % 3 for row in range(N)])


def in_disorder() -> Fields:
    return shuffled(one())


CASES = [
    one,
    in_disorder,
    two_in_disorder,
    fleet_on_end,
    zones_that_differ,
    segments_that_come_back,
    with_speeds,
]


def pairs(*forms: str) -> list[tuple[Callable[[], Fields], str]]:
    """Cases and forms; GPX needs points in time."""
    return [
        (case, form)
        for case in CASES
        for form in forms
        if form != "gpx" or any(isinstance(moment, str) for moment in case()["time"])
    ]


def clean(*arguments: object) -> Result:
    return CliRunner().invoke(app, ["clean", *map(str, arguments)])


def written(folder: Path, form: str, *arguments: object) -> bytes:
    out = folder / f"clean.{form}"
    result = clean(*arguments, "--points", "-o", out)
    assert result.exit_code == 0, result.stderr
    return out.read_bytes()


def whole(paths: list[Path], form: str, **arguments: Any) -> bytes:
    """The file that is made of the answer held as a whole."""
    given = TrackArguments(**arguments)
    recordings = read_files(
        paths, columns={}, time_unit=given.time_unit, limits=Limits(), check=lambda: None, field="file"
    )
    recorded = of_files(recordings, [path.name for path in paths], given.time_unit)
    cleaned = clean_recorded(recorded, given, lambda _done, _total: None)
    writer = next(row for row in WRITERS if row.name == form)
    return b"".join(writer.write(cleaned, TrackAnswerQuery(points=True)))


@pytest.mark.parametrize(("case", "form"), pairs("csv", "geojson", "gpx", "arrow", "parquet"))
def test_the_bytes_are_those_of_the_whole(case: Callable[[], Fields], form: str, tmp_path: Path) -> None:
    path = tmp_path / "track.csv"
    path.write_bytes(as_csv(case()))
    assert written(tmp_path, form, path) == whole([path], form)


@pytest.mark.parametrize(("case", "form"), pairs("csv", "geojson", "gpx"))
def test_the_pieces_do_not_show(
    case: Callable[[], Fields], form: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cleaning, "_PIECE_ROWS", 16)
    monkeypatch.setattr(spool, "PIECE_ROWS", 7)
    path = tmp_path / "track.csv"
    path.write_bytes(as_csv(case()))
    assert written(tmp_path, form, path) == whole([path], form)


@pytest.mark.parametrize(("case", "form"), pairs("arrow", "parquet"))
def test_tables_in_pieces_are_equal_to_the_whole(
    case: Callable[[], Fields], form: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cleaning, "_PIECE_ROWS", 16)
    monkeypatch.setattr(spool, "PIECE_ROWS", 7)
    path = tmp_path / "track.csv"
    path.write_bytes(as_csv(case()))

    def table(content: bytes) -> Any:
        return (
            pq.read_table(io.BytesIO(content))
            if form == "parquet"
            else pa.ipc.open_stream(content).read_all()
        )

    found, expected = table(written(tmp_path, form, path)), table(whole([path], form))
    assert found.equals(expected, check_metadata=True)


@pytest.mark.parametrize("form", ["csv", "geojson", "arrow", "parquet"])
@pytest.mark.parametrize(("step", "first"), [(1000, 0), (1000.5, 0), (1000.5, None)])
def test_numbers_since_1970_go_out_as_they_came(
    form: str, step: float, first: int | None, tmp_path: Path
) -> None:
    path = tmp_path / "track.csv"
    path.write_bytes(as_csv(walk(time=[first, *(1_700_000_000_000 + step * row for row in range(1, N))])))
    assert written(tmp_path, form, path, "--time-unit", "ms") == whole([path], form, time_unit="ms")


def test_a_missing_time_leaves_the_others_whole_numbers(tmp_path: Path) -> None:
    path = tmp_path / "track.csv"
    times = [None, *(1_700_000_000_000 + 1000 * row for row in range(1, N))]
    path.write_bytes(as_csv(walk(time=times)))
    content = written(tmp_path, "arrow", path, "--time-unit", "ms")
    found = pa.ipc.open_stream(content).read_all()["time"]
    assert found.type == pa.int64()
    assert found.to_pylist() == times


def test_several_files_and_formats_make_the_file_of_the_whole(tmp_path: Path) -> None:
    ride, fleet = tmp_path / "ride.gpx", tmp_path / "fleet.csv"
    ride.write_bytes(as_gpx(walk(time=clock())))
    fleet.write_bytes(as_csv(two_in_disorder()))
    for form in ("csv", "gpx"):
        assert written(tmp_path, form, ride, fleet) == whole([ride, fleet], form)


def test_a_device_without_a_track_is_remarked_on_after_the_file(tmp_path: Path) -> None:
    path, out = tmp_path / "fleet.csv", tmp_path / "clean.csv"
    path.write_bytes(as_csv(fleet_on_end()))
    result = clean(path, "-o", out)
    wrote, refused = result.stderr.splitlines()
    assert wrote == f"Wrote {out}."
    assert refused.startswith("parked has no track: all fixes have the same time")


@pytest.mark.parametrize("devices", [{}, {"device": ["a", "b"]}])
def test_nothing_is_written_where_there_is_no_track(tmp_path: Path, devices: Fields) -> None:
    path, out = tmp_path / "still.csv", tmp_path / "clean.csv"
    path.write_bytes(as_csv({"time": [0, 0], "lat": [95, 95], "lon": [2, 4]} | devices))
    result = clean(path, "-o", out)
    assert (result.exit_code, result.stdout) == (1, "")
    assert "no fix has both a time and a place on Earth" in result.stderr
    assert not out.exists()


def test_a_device_whose_times_are_in_another_unit_leaves_no_half_a_file(tmp_path: Path) -> None:
    fields = two_walks()
    fields["time"] = [1e9 * row if row % 2 else row for row in range(2 * N)]
    path, out = tmp_path / "fleet.csv", tmp_path / "clean.csv"
    path.write_bytes(as_csv(fields))
    result = clean(path, "-o", out)
    assert (result.exit_code, result.stdout) == (2, "")
    assert "300 years" in result.stderr
    assert not out.exists()


def test_no_room_for_temporary_files_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "fleet.csv"
    path.write_bytes(as_csv(two_walks()))
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "none"))
    result = clean(path, "--to", "csv")
    assert (result.exit_code, result.stdout) == (2, "")
    assert "set TMPDIR" in result.stderr


def test_speeds_are_taken_from_the_columns_named(tmp_path: Path) -> None:
    fields = with_speeds()
    path, renamed = tmp_path / "plain.csv", tmp_path / "renamed.csv"
    path.write_bytes(as_csv(fields))
    renamed.write_bytes(
        as_csv({{"speed": "doppler", "bearing": "way"}.get(name, name): fields[name] for name in fields})
    )
    helped = written(tmp_path, "csv", path)
    assert written(tmp_path, "csv", renamed, "--speed", "doppler", "--bearing", "way") == helped
    assert written(tmp_path, "csv", renamed) != helped


def test_arrow_is_told_to_give_memory_back_unless_the_user_chose(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "walk.csv"
    path.write_bytes(as_csv(walk()))
    monkeypatch.delenv("ARROW_DEFAULT_MEMORY_POOL", raising=False)
    written(tmp_path, "csv", path)
    assert os.environ["ARROW_DEFAULT_MEMORY_POOL"] == "system"
    monkeypatch.setenv("ARROW_DEFAULT_MEMORY_POOL", "mimalloc")
    written(tmp_path, "csv", path)
    assert os.environ["ARROW_DEFAULT_MEMORY_POOL"] == "mimalloc"
