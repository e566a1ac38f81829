"""``plumbline fit-many``: a table of many series to a table with a row for each.

The table is read in pieces, only the columns needed, and fitted and written slice by slice, so that memory
holds the columns once and little besides. The output appears under its name when it is complete.
"""

from __future__ import annotations

import contextlib
import dataclasses
import io
import os
import sys
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO

import pyarrow as pa
import pyarrow.compute as pc
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from service.batches import answer_batch
from service.cli.moments import read_moment_like
from service.cli.streams import NO_TREND, fail, messages, remark
from service.codecs.arguments import read_arguments
from service.codecs.batch import arrow, parquet
from service.codecs.batch.answer import Answer
from service.codecs.batch.csv import read_csv
from service.codecs.batch.documents import write_geojson, write_json, write_ndjson
from service.codecs.batch.json import read_json
from service.codecs.batch.rows import Batch, Reading
from service.codecs.batch.tables import write_arrow, write_arrow_file, write_csv, write_parquet
from service.codecs.columns import Columns, Times
from service.codecs.limits import Limits
from service.codecs.table import TableError, read_delimiter
from service.codecs.table_text import find_delimiter
from service.errors import Problem
from service.schemas.fields import TimeUnit
from service.schemas.options import FitArguments, read_periods

WRITERS: dict[str, Callable[[Answer], Iterator[bytes]]] = {
    ".csv": write_csv,
    ".parquet": write_parquet,
    ".arrow": write_arrow_file,
    ".feather": write_arrow_file,
    ".arrows": write_arrow,
    ".json": write_json,
    ".ndjson": write_ndjson,
    ".jsonl": write_ndjson,
    ".geojson": write_geojson,
}

#: Every message of an Arrow stream begins with this continuation marker.
_ARROW_STREAM = b"\xff\xff\xff\xff"
_HEAD = 64 * 1024

# How the fields of a problem are called on the command line.
_OPTION_OF = {
    "series_column": "--by",
    "series": "the column of --by",
    "time": "the time column",
    "value": "the value column",
    "weight": "the weight column",
    "lat": "the column of --lat",
    "lon": "the column of --lon",
}


@dataclass(frozen=True, slots=True)
class FitManyRequest:
    """What the command line asks for; see ``plumbline fit-many --help``."""

    file: str
    output: str
    by: str
    time: str | None
    value: str | None
    weight: str | None
    lat: str | None
    lon: str | None
    delimiter: str | None
    time_unit: TimeUnit | None
    model: str
    method: str
    threshold: float | None
    sigma: float | None
    level: float
    seed: int
    points: bool
    noise: str = "auto"
    uncertainty: str = "effective-n"
    resamples: int | None = None
    degree: int | None = None
    seasonal: tuple[str, ...] = ()
    harmonics: int | None = None
    regime: str = "all"
    reach: tuple[float, ...] = ()
    horizon: str | None = None


def run_fit_many(request: FitManyRequest) -> None:
    """Fit and write; ends the command with code 1 or 2 where it cannot.

    Parameters
    ----------
    request : FitManyRequest
    """
    write = _writer(request.output)
    try:
        arguments = _arguments(request)
        with _opened(request.file) as source:
            batch = _read(source, request)
    except Problem as problem:
        fail(f"{_source(request.file)}: {_told(problem)}.")
    except (TableError, OSError) as error:
        reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        fail(f"{_source(request.file)}: {reason}.")
    fitted = _fit(batch, arguments, request, write)
    total = len(batch.names)
    place = "standard output" if request.output == "-" else request.output
    without = f", {total - fitted} of them without a trend" if fitted < total else ""
    remark(f"Wrote {total} series to {place}{without}.")
    if not fitted:
        fail("no series has a trend; the column 'reason' says why.", NO_TREND)


def _writer(output: str) -> Callable[[Answer], Iterator[bytes]]:
    if output == "-":
        return write_csv
    path = Path(output)
    if path.suffix.lower() not in WRITERS:
        fail(f"--output {output}: the ending says the format; use one of {', '.join(WRITERS)}.")
    if path.is_dir():
        fail(f"--output {output}: is a directory; name a file.")
    if not path.parent.is_dir():
        fail(f"--output {output}: there is no directory {path.parent}; make it, or choose another place.")
    return WRITERS[path.suffix.lower()]


def _arguments(request: FitManyRequest) -> FitArguments:
    given = {
        "time_unit": request.time_unit,
        "model": request.model,
        "method": request.method,
        "threshold": request.threshold,
        "sigma": request.sigma,
        "level": request.level,
        "seed": request.seed,
        "noise": request.noise,
        "uncertainty": request.uncertainty,
        "degree": request.degree,
        "seasonal": read_periods(request.seasonal) if request.seasonal else None,
        "harmonics": request.harmonics,
        "regime": request.regime,
        "reach": list(request.reach) or None,
        "options": {} if request.resamples is None else {"resamples": request.resamples},
    }
    try:
        return read_arguments(given)
    except Problem as problem:
        fail(f"{_told(problem)}.")


@contextlib.contextmanager
def _opened(file: str) -> Iterator[Any]:
    """Seekable source of a file or of standard input."""
    if file == "-":
        yield pa.BufferReader(sys.stdin.buffer.read())
        return
    if Path(file).is_dir():
        raise TableError("is a directory; give a file, or - for standard input")
    with pa.OSFile(file, "r") as source:
        yield source


def _read(source: Any, request: FitManyRequest) -> Batch:
    """Batch of a file in the format that its first bytes say."""
    columns = {
        "series": request.by,
        "time": request.time,
        "value": request.value,
        "weight": request.weight,
        "lat": request.lat,
        "lon": request.lon,
    }
    reading = Reading(columns, request.time_unit, Limits(), check=lambda: None)
    head = source.read(_HEAD)
    source.seek(0)
    if not head.strip():
        raise TableError("the input is empty; give a table of series, times and values")
    if head.startswith(parquet.MAGIC):
        return parquet.read_parquet(source, reading)
    if head.startswith((arrow.MAGIC, _ARROW_STREAM)):
        return arrow.read_arrow(source, reading)
    if head.lstrip().startswith(b"{"):
        return read_json(source, reading)
    if request.delimiter is not None:
        return read_csv(source, reading, read_delimiter(request.delimiter))
    return read_csv(source, reading, find_delimiter(head.decode("utf-8-sig", errors="replace")))


def _fit(
    batch: Batch, arguments: FitArguments, request: FitManyRequest, write: Callable[[Answer], Iterator[bytes]]
) -> int:
    """Fit and write all series; returns how many have a trend."""
    fitted = 0

    def counted(parts: Iterator[Any]) -> Iterator[Any]:
        nonlocal fitted
        for part in parts:
            fitted += pc.sum(part.column("fitted")).as_py()
            yield part

    try:
        with _progress(len(batch.names)) as tell, _sink(request.output) as sink:
            answer = answer_batch(
                batch,
                arguments,
                horizon=_horizon(batch, request.horizon),
                points=request.points,
                threads=None,
                progress=tell,
            )
            for piece in write(dataclasses.replace(answer, parts=counted(answer.parts))):
                sink.write(piece)
    except Problem as problem:
        fail(f"{_told(problem)}.")
    except TableError as error:
        fail(f"{error}.")
    except OSError as error:
        fail(f"--output {request.output}: cannot be written ({error.strerror}); choose another place.")
    return fitted


def _horizon(batch: Batch, text: str | None) -> Times | None:
    if text is None:
        return None
    times = Columns(batch.time, batch.value, None, None, batch.form)
    return read_moment_like(times, [text], "--horizon")


@contextlib.contextmanager
def _progress(total: int) -> Iterator[Callable[[int, int], None]]:
    """Bar on standard error if it is a terminal, silence if not."""
    console = messages()
    if not console.is_terminal:
        yield lambda _done, _total: None
        return
    columns = (TextColumn("Fitting"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=console, transient=True) as shown:
        task = shown.add_task("series", total=total)
        yield lambda done, _total: shown.update(task, completed=done)


@contextlib.contextmanager
def _sink(output: str) -> Iterator[BinaryIO]:
    """Where the answer goes: a file beside the output that takes its name once it is complete."""
    if output == "-":
        yield sys.stdout.buffer if isinstance(sys.stdout, io.TextIOWrapper) else sys.stdout  # type: ignore[misc]
        sys.stdout.flush()
        return
    path = Path(output)
    handle, name = tempfile.mkstemp(prefix=f".{path.name}.", dir=path.parent)
    part = Path(name)
    try:
        with os.fdopen(handle, "wb") as sink:
            yield sink
        part.chmod(0o666 & ~_umask())
        part.replace(path)
    finally:
        part.unlink(missing_ok=True)


def _umask() -> int:
    """Permissions that new files do not get; it can only be read by setting it."""
    current = os.umask(0o022)
    os.umask(current)
    return current


def _source(file: str) -> str:
    return "standard input" if file == "-" else file


def _told(problem: Problem) -> str:
    """Word a problem as the end of a sentence, with the options of the command line."""
    if not problem.errors:
        return problem.detail
    found = problem.errors[0]
    option = _OPTION_OF.get(found.field)
    if option is None:
        option = "the file" if found.field == "body" else f"--{_as_option(found.field)}"
    row = "" if found.row is None else f", row {found.row}"
    return f"{option}{row}: {found.message}"


def _as_option(field: str) -> str:
    return field.removesuffix("_column").removeprefix("options.").replace("_", "-")
