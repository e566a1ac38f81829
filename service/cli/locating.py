"""``plumbline locate``: a table of ranges, a RINEX file or a phone's log to positions."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import typer

from service.cli.streams import NO_TREND, answers, fail, remark
from service.codecs.arguments import validated
from service.codecs.limits import Limits
from service.codecs.positions.columns import Recording
from service.codecs.positions.pictures import check_picture
from service.codecs.positions.registry import READERS, WRITERS
from service.codecs.sent import Sent
from service.errors import Problem, ProblemType
from service.positions.located import Located
from service.positions.prepared import Prepared, prepare_recording
from service.positions.recordings import kind_of
from service.schemas.options import OPTION_PREFIX
from service.schemas.position_query import TRUTH, PositionQuery
from service.schemas.positions import PositionSettings, RecordingArguments

LocateOutput = Literal["text", "json", "csv", "arrow", "parquet", "geojson", "svg", "png"]

#: By the bytes that a file begins with; what begins with none of them is read as CSV.
_MAGIC = {
    b"PAR1": "application/vnd.apache.parquet",
    b"ARROW1": "application/vnd.apache.arrow.file",
    b"\xff\xff\xff\xff": "application/vnd.apache.arrow.stream",
}
_MOST_ROWS = 10_000_000
_BINARY = ("png", "arrow", "parquet")


@dataclass(frozen=True, slots=True)
class LocateRequest:
    """What the command line asks for; see ``plumbline locate --help``.

    Attributes
    ----------
    file : str
    nav : tuple of Path
    arguments : mapping of str to object
        By their names in the query of the service; None where not given.
    options : tuple of str
        ``name=value`` each.
    truth : tuple of str or None
        Latitude, longitude, height.
    answer : mapping of str to object
        What shapes the answer, likewise.
    output_format : str
    output : Path or None
    """

    file: str
    nav: tuple[Path, ...]
    arguments: Mapping[str, Any]
    options: tuple[str, ...]
    truth: tuple[str, ...] | None
    answer: Mapping[str, Any]
    output_format: LocateOutput
    output: Path | None


def run_locate(request: LocateRequest) -> None:
    """Locate and print or write; ends the command with code 1 or 2 where it cannot.

    Parameters
    ----------
    request : LocateRequest
    """
    source = "standard input" if request.file == "-" else request.file
    if request.output_format in _BINARY and request.output is None:
        fail(f"--format {request.output_format}: name the file with --output.")
    if request.output is not None and not request.output.parent.is_dir():
        fail(f"--output {request.output}: there is no directory {request.output.parent}.")
    body = _bytes_of(request.file)
    try:
        query = _query(request)
        prepared = _prepared(body, query, request)
        if request.output_format in ("svg", "png"):
            check_picture(query, many=prepared.is_series)
        located = prepared.locate(lambda _done, _total: None)
        _put(located, query, request)
    except Problem as problem:
        code = NO_TREND if problem.kind is ProblemType.no_position else 2
        fail(f"{source}: {problem.detail.rstrip('.')}.", code)


def _prepared(body: bytes, query: PositionQuery, request: LocateRequest) -> Prepared:
    limits = Limits(points=_MOST_ROWS)
    if kind_of(body) is not None:
        if not request.nav:
            fail(f"{request.file}: give the broadcast messages of its days with --nav FILE.")
        if query.rotated is not None:
            fail("--rotated: is for tables; the orbits of this file are computed here.")
        absent = next((path for path in request.nav if not path.is_file()), None)
        if absent is not None:
            fail(f"--nav {absent}: there is no such file.")
        arguments = validated(RecordingArguments, query.arguments())
        return prepare_recording(Recording(body, request.nav), arguments, limits, _nobody_leaves)
    if request.nav:
        fail(f"--nav: {request.file} is neither RINEX nor a GnssLogger log; tables carry their satellites.")
    if query.rotated is None:
        fail(
            "--rotated or --not-rotated: say whether satellite positions are turned for the Earth's rotation."
        )
    media_type = next((name for magic, name in _MAGIC.items() if body.startswith(magic)), "text/csv")
    return READERS[media_type].read(Sent(body, media_type, query, limits, _nobody_leaves))


def _query(request: LocateRequest) -> PositionQuery:
    given = {**request.answer, **request.arguments}
    for text in request.options:
        name, found, value = text.partition("=")
        if not found or name not in PositionSettings.model_fields:
            fail(f"--option {text}: give NAME=VALUE with one of {', '.join(PositionSettings.model_fields)}.")
        given[OPTION_PREFIX + name] = value
    if request.truth is not None:
        if len(request.truth) != len(TRUTH):
            fail("--truth: give latitude, longitude and height, such as 52.5,13.4,80.")
        given |= dict(zip(TRUTH, request.truth, strict=True))
    return validated(PositionQuery, {name: value for name, value in given.items() if value is not None})


def _nobody_leaves() -> None:
    """Who calls from a terminal waits, or ends the process."""


def _bytes_of(file: str) -> bytes:
    if file == "-":
        return sys.stdin.buffer.read()
    try:
        return Path(file).read_bytes()
    except FileNotFoundError:
        fail(f"{file}: there is no such file; check the name, or give - for standard input.")
    except OSError as error:
        fail(f"{file}: cannot be read ({error.strerror}).")


def _put(located: Located, query: PositionQuery, request: LocateRequest) -> None:
    if request.output_format == "text":
        content = f"{located.answer.summary()}\n".encode()
    else:
        writer = next(row for row in WRITERS if row.name == request.output_format)
        content = writer.write(located, query)
    if request.output is None:
        answers()  # prepares the stream for letters that a terminal lacks
        typer.echo(content.decode(), nl=request.output_format == "json")
        return
    try:
        request.output.write_bytes(content)
    except OSError as error:
        fail(f"--output {request.output}: cannot be written ({error.strerror}); choose another place.")
    remark(f"Wrote {request.output}.")
