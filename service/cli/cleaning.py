"""``plumbline clean``: track files to cleaned tracks; reading, cleaning and writing are steps apart."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import typer

from estimators import NoFit
from estimators.adapters.tracks.source import Source
from service.cli.cleaning_rows import clean_rows, is_of_rows
from service.cli.making import Made
from service.cli.streams import NO_TREND, answers, fail, remark
from service.codecs.arguments import validated
from service.codecs.limits import Limits
from service.codecs.trajectories.registry import WRITERS, TrackWriter
from service.errors import Problem, ProblemType
from service.schemas.fields import Theme
from service.schemas.trajectories import Figure, TrackAnswerQuery, TrackArguments
from service.trajectories.cleaned import CleanedTracks, clean_recorded, refusal_of
from service.trajectories.files import read_files
from service.trajectories.recorded import Recorded, of_files

CleanOutput = Literal["text", "json", "geojson", "gpx", "csv", "arrow", "parquet"]

#: By the ending of a file; ``--to`` takes precedence.
ENDINGS: dict[str, CleanOutput] = {
    ".json": "json",
    ".geojson": "geojson",
    ".gpx": "gpx",
    ".csv": "csv",
    ".arrow": "arrow",
    ".arrows": "arrow",
    ".parquet": "parquet",
    ".txt": "text",
}
_BINARY = ("arrow", "parquet")
STDIN = "standard input"


@dataclass(frozen=True, slots=True)
class CleanRequest:
    """What the command line asks for; see ``plumbline clean --help``.

    Attributes
    ----------
    files : tuple of str
        ``-`` is standard input.
    columns : mapping of str to str or None
        Columns of tables by what they are; None where not named.
    arguments : mapping of str to object
        By their names in the query of the service; None where not given.
    points : bool
        GeoJSON: a point per fix.
    to : str or None
    output, plot : Path or None
    figure, theme : str
        Of the picture.
    """

    files: tuple[str, ...]
    columns: Mapping[str, str | None]
    arguments: Mapping[str, Any]
    points: bool
    to: CleanOutput | None
    output: Path | None
    plot: Path | None = None
    figure: Figure = "map"
    theme: Theme = "light"


def run_clean(request: CleanRequest) -> None:
    """Clean and print or write; ends the command with code 1 or 2 where it cannot.

    Parameters
    ----------
    request : CleanRequest
    """
    # Before pyarrow is imported, which reads it once. Its own pools keep what they have had: on ten million
    # rows that is a hundred megabytes.
    os.environ.setdefault("ARROW_DEFAULT_MEMORY_POOL", "system")
    form = _form(request)
    writer = next((row for row in WRITERS if row.name == form), None)
    artist = None if request.plot is None else _artist(request.plot)
    source = ", ".join(STDIN if file == "-" else file for file in request.files)
    try:
        arguments = validated(
            TrackArguments, {name: value for name, value in request.arguments.items() if value is not None}
        )
        recorded = _read(request, arguments)
        for chosen in filter(None, (writer, artist)):
            chosen.check(recorded)
        cleaned = None
        if artist is None and is_of_rows(form, points=request.points):
            made = clean_rows(recorded, arguments, form)
        else:
            cleaned = clean_recorded(recorded, arguments, lambda _done, _total: None)
            made = _made(cleaned, writer, points=request.points)
    except Problem as problem:
        fail(f"{source}: {problem.detail.rstrip('.')}.", 1 if problem.kind is ProblemType.no_track else 2)
    except OSError as error:
        fail(f"temporary files cannot be written ({error.strerror}); set TMPDIR to a folder with more room.")
    if not made.has_track:
        fail(f"{source}: no device has a track; {_why(made.refused[0][1])}.", NO_TREND)
    _put(made.pieces, request.output, is_text=writer is None)
    if request.plot is not None and artist is not None and cleaned is not None:
        _draw(cleaned, artist, request.plot, request)
    for device, told in made.refused:
        remark(f"{_name(device)} has no track: {_why(told)}.")


def _form(request: CleanRequest) -> CleanOutput:
    """Tell what is written, checked before the work against where it goes."""
    ending = None if request.output is None else ENDINGS.get(request.output.suffix.lower())
    form = request.to or ending or "text"
    if request.output is None and form in _BINARY:
        fail(f"--to {form}: name the file with --output.")
    if request.output is not None and not request.output.parent.is_dir():
        fail(f"--output {request.output}: there is no directory {request.output.parent}.")
    if request.files.count("-") > 1:
        fail("-: standard input can be read once; name it once.")
    return form


def _artist(path: Path) -> TrackWriter:
    """Find who writes a picture, checked before the work against where it goes."""
    artist = next((row for row in WRITERS if row.is_picture and f".{row.name}" == path.suffix.lower()), None)
    if artist is None:
        fail(f"--plot {path}: a picture is written as .png or .svg; change the ending.")
    if not path.parent.is_dir():
        fail(f"--plot {path}: there is no directory {path.parent}; make it, or choose another place.")
    return artist


def _draw(cleaned: CleanedTracks, artist: TrackWriter, path: Path, request: CleanRequest) -> None:
    query = TrackAnswerQuery(figure=request.figure, theme=request.theme)
    _save(artist.write(cleaned, query), path, "--plot")


def _read(request: CleanRequest, arguments: TrackArguments) -> Recorded:
    recordings = read_files(
        [_source(file) for file in request.files],
        columns={role: name for role, name in request.columns.items() if name is not None},
        time_unit=arguments.time_unit,
        limits=Limits(),
        check=lambda: None,
        field="file",
    )
    lost = sum(recording.left_out for recording in recordings)
    if lost:
        remark(f"Records left out because their checksum is wrong: {lost}.")
    return of_files(
        recordings, [STDIN if file == "-" else Path(file).name for file in request.files], arguments.time_unit
    )


def _source(file: str) -> Source:
    if file == "-":
        return sys.stdin.buffer.read()
    path = Path(file)
    if path.is_dir():
        fail(f"{file}: is a directory; give its files, or - for standard input.")
    if not path.exists():
        fail(f"{file}: there is no such file; check the name, or give - for standard input.")
    return path


def _made(cleaned: CleanedTracks, writer: TrackWriter | None, *, points: bool) -> Made:
    refused = [(item.device, item.answer) for item in cleaned.tracks if isinstance(item.answer, NoFit)]
    pieces = _pieces(cleaned, writer, points=points)
    return Made(pieces, refused, has_track=len(refused) < len(cleaned.tracks))


def _pieces(cleaned: CleanedTracks, writer: TrackWriter | None, *, points: bool) -> Iterator[bytes]:
    if writer is None:
        return _summaries(cleaned)
    query = TrackAnswerQuery(points=points or None)
    pieces = writer.write(cleaned, query)
    return _ended(pieces) if writer.name == "json" else pieces


def _summaries(cleaned: CleanedTracks) -> Iterator[bytes]:
    """Text for people, a piece for each track."""
    told = [item for item in cleaned.tracks if not isinstance(item.answer, NoFit)]
    for place, item in enumerate(told):
        title = f"{_name(item.device)}\n" if cleaned.recorded.is_many else ""
        yield f"{chr(10) if place else ''}{title}{item.answer.summary()}\n".encode()


def _ended(pieces: Iterator[bytes]) -> Iterator[bytes]:
    yield from pieces
    yield b"\n"


def _name(device: str | None) -> str:
    return device or "(no name)"


def _why(told: NoFit) -> str:
    return str(refusal_of(told)["message"]).rstrip(".")


def _put(pieces: Iterator[bytes], output: Path | None, *, is_text: bool) -> None:
    if output is None:
        answers()  # prepares the stream for letters that a terminal lacks
        for piece in pieces:
            typer.echo(piece.decode() if is_text else piece, nl=False)
        return
    _save(pieces, output, "--output")


def _save(pieces: Iterator[bytes], path: Path, option: str) -> None:
    try:
        with path.open("wb") as file:
            for piece in pieces:
                file.write(piece)
    except OSError as error:
        fail(f"{option} {path}: cannot be written ({error.strerror}); choose another place.")
    remark(f"Wrote {path}.")
