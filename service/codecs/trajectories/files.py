"""Bodies that are track files, or uploads of them; the arguments come in the query."""

from __future__ import annotations

from estimators.adapters.tracks.source import Source
from service.codecs.arguments import validated
from service.codecs.multipart import read_parts
from service.codecs.sent import Sent
from service.errors import invalid_value
from service.schemas.trajectories import TrackArguments, TrackQuery
from service.trajectories.files import read_files
from service.trajectories.recorded import Recorded, of_files

FILE = "file"


def read_body_file(sent: Sent[TrackQuery]) -> tuple[Recorded, TrackArguments]:
    """Read the fixes of a body that is one file.

    Raises
    ------
    Problem
        If it cannot be read, or an argument is wrong.
    """
    return _read(sent, [sent.content], [""], "body")


def read_upload(sent: Sent[TrackQuery]) -> tuple[Recorded, TrackArguments]:
    """Read the fixes of ``multipart/form-data`` with one part ``file`` or several.

    Raises
    ------
    Problem
        If a part is unknown or cannot be read, or an argument is wrong.
    """
    parts = read_parts(sent)
    for part in parts:
        if part.name != FILE:
            raise invalid_value(part.name[:60] or "body", f"this part is not taken; send files as {FILE}")
    if not parts:
        raise invalid_value(FILE, "is missing; send one or several track files in parts of this name")
    return _read(sent, [part.content for part in parts], [part.filename[:100] for part in parts], FILE)


def _read(
    sent: Sent[TrackQuery], sources: list[Source], names: list[str], field: str
) -> tuple[Recorded, TrackArguments]:
    arguments = validated(TrackArguments, sent.query.arguments())
    recordings = read_files(
        sources,
        columns=sent.query.columns(),
        time_unit=arguments.time_unit,
        limits=sent.limits,
        check=sent.check,
        field=field,
    )
    return of_files(recordings, names, arguments.time_unit), arguments
