"""``plumbline locate``: a table of ranges, a RINEX file or a phone's log to positions."""

from __future__ import annotations

import sys
import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import typer
from pydantic import ValidationError

from estimators import Epochs, Fix, Fixes, InputError, NoFit, PositionOptions, locate
from estimators.gnss.observed_epochs import ObservedEpochs
from service.cli.streams import NO_TREND, answers, fail, remark
from service.codecs.arguments import from_validation
from service.codecs.positions.columns import check_ranges, read_position_arguments
from service.codecs.positions.read import read_csv_ranges
from service.codecs.positions.write import POSITION_WRITERS, refuse_picture_of_many
from service.errors import Problem, ProblemType
from service.positions import Located, locate_columns, locate_many
from service.schemas.fields import TimeUnit
from service.schemas.positions import Motion, PositionAnswerQuery, PositionArguments, PositionQuery

LocateOutput = Literal["text", "json", "csv", "geojson", "svg", "png"]

_MOST_ROWS = 10_000_000
_GZIP = b"\x1f\x8b"
_HEAD = 4096


@dataclass(frozen=True, slots=True)
class LocateRequest:
    """What the command line asks for; see ``plumbline locate --help``."""

    file: str
    nav: tuple[Path, ...]
    rotated: bool | None
    method: str
    motion: Motion | None
    time_unit: TimeUnit | None
    mask: float | None
    output_format: LocateOutput
    output: Path | None


def run_locate(request: LocateRequest) -> None:
    """Locate and print or write; ends the command with code 1 or 2 where it cannot.

    Parameters
    ----------
    request : LocateRequest
    """
    source = "standard input" if request.file == "-" else request.file
    if request.output_format == "png" and request.output is None:
        fail("--format png: name the file with --output.")
    if request.output is not None and not request.output.parent.is_dir():
        fail(f"--output {request.output}: there is no directory {request.output.parent}.")
    body = _bytes_of(request.file)
    try:
        located = _locate(body, request)
    except Problem as problem:
        code = NO_TREND if problem.kind is ProblemType.no_position else 2
        fail(f"{source}: {problem.detail.rstrip('.')}.", code)
    except InputError as error:
        fail(f"{source}: {error.field}: {error.message}.")
    except ImportError:
        fail(f"{source}: reading RINEX needs the extra [rinex]; install plumbline[rinex].")
    _put(located, request)


def _locate(body: bytes, request: LocateRequest) -> Located:
    head = _head(body)
    is_rinex = b"RINEX VERS" in head
    if is_rinex or b"# Raw," in head or head.startswith(b"Raw,"):
        if not request.nav:
            fail(f"{request.file}: give the broadcast messages of its days with --nav FILE.")
        if request.rotated is not None:
            fail("--rotated: is for tables; the orbits of this file are computed here.")
        return _locate_observed(_observed(body, request, rinex=is_rinex), request)
    if request.nav:
        fail(f"--nav: {request.file} is neither RINEX nor a GnssLogger log; tables carry their satellites.")
    if request.rotated is None:
        fail(
            "--rotated or --not-rotated: say whether satellite positions are turned for the Earth's rotation."
        )
    columns, arguments = read_csv_ranges(body, _query(request))
    check_ranges(columns, arguments, _MOST_ROWS)
    _refuse_picture(request, many=columns.time is not None)
    return locate_columns(columns, arguments, _ignore)


def _head(body: bytes) -> bytes:
    """First bytes of a file, of what is in it where it is compressed."""
    if not body.startswith(_GZIP):
        return body[:_HEAD]
    try:
        return zlib.decompressobj(zlib.MAX_WBITS | 16).decompress(body, _HEAD)
    except zlib.error:
        fail("the file begins as gzip and cannot be unpacked; fetch it anew.")


def _query(request: LocateRequest) -> PositionQuery:
    given = {
        "rotated": request.rotated,
        "method": request.method,
        "motion": request.motion,
        "time_unit": request.time_unit,
        "options.elevation_mask_deg": request.mask,
    }
    try:
        return PositionQuery.model_validate(
            {name: value for name, value in given.items() if value is not None}
        )
    except ValidationError as error:
        raise from_validation(error.errors(include_input=False, include_url=False)) from None


def _observed(body: bytes, request: LocateRequest, *, rinex: bool) -> ObservedEpochs:
    """Epochs of a RINEX file or a log, corrected by broadcast messages."""
    # Only who has such a file waits for the readers, and needs their extra.
    from estimators.adapters.gnss_logger import read_gnss_logger  # noqa: PLC0415
    from estimators.adapters.rinex import read_rinex  # noqa: PLC0415

    absent = next((path for path in request.nav if not path.is_file()), None)
    if absent is not None:
        fail(f"--nav {absent}: there is no such file.")
    read = read_rinex if rinex else read_gnss_logger
    return (
        read(body, list(request.nav))
        if request.mask is None
        else read(body, list(request.nav), mask_deg=request.mask)
    )


def _locate_observed(observed: ObservedEpochs, request: LocateRequest) -> Located:
    epochs = Epochs.from_observed(observed)
    motion = request.motion
    many = len(epochs) != 1
    _refuse_picture(request, many=many)
    given = {"rotated": True, "method": request.method} | ({} if motion is None else {"motion": motion})
    arguments: PositionArguments = read_position_arguments(given)
    if many or motion is not None:
        fixes = locate_many(epochs, arguments, PositionOptions(), _ignore)
        return Located(_or_fail(fixes, request))
    epoch = epochs[0]
    fix = locate(
        epoch.satellites_m,
        epoch.pseudoranges_m,
        sigma_m=epoch.sigma_m,
        system=epoch.system,
        satellite=epoch.satellite,
        method=arguments.method,
    )
    return Located(_or_fail(fix, request))


def _or_fail(answer: Fix | Fixes | NoFit, request: LocateRequest) -> Fix | Fixes:
    if isinstance(answer, NoFit):
        fail(f"{request.file}: no position ({answer.reason.value}): {answer.message.rstrip('.')}.", NO_TREND)
    return answer


def _ignore(_done: int, _total: int) -> None:
    return None


def _refuse_picture(request: LocateRequest, *, many: bool) -> None:
    for writer in POSITION_WRITERS:
        if writer.name == request.output_format:
            refuse_picture_of_many(writer, many=many)


def _bytes_of(file: str) -> bytes:
    if file == "-":
        return sys.stdin.buffer.read()
    try:
        return Path(file).read_bytes()
    except FileNotFoundError:
        fail(f"{file}: there is no such file; check the name, or give - for standard input.")
    except OSError as error:
        fail(f"{file}: cannot be read ({error.strerror}).")


def _put(located: Located, request: LocateRequest) -> None:
    if request.output_format == "text":
        content = f"{located.answer.summary()}\n".encode()
    else:
        writer = next(row for row in POSITION_WRITERS if row.name == request.output_format)
        content = writer.write(located, PositionAnswerQuery())
    if request.output is None:
        answers()  # prepares the stream for letters that a terminal lacks
        typer.echo(content.decode(), nl=request.output_format == "json")
        return
    try:
        request.output.write_bytes(content)
    except OSError as error:
        fail(f"--output {request.output}: cannot be written ({error.strerror}); choose another place.")
    remark(f"Wrote {request.output}.")
