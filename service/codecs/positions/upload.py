"""Files by upload: ``multipart/form-data`` with the parts ``observations`` and ``navigation``."""

from __future__ import annotations

from service.codecs.arguments import validated
from service.codecs.multipart import read_parts
from service.codecs.positions.columns import Recording
from service.codecs.sent import Sent
from service.errors import invalid_value
from service.schemas.position_query import PositionQuery
from service.schemas.positions import RecordingArguments

OBSERVATIONS, NAVIGATION = "observations", "navigation"


def read_upload(sent: Sent[PositionQuery]) -> tuple[Recording, RecordingArguments]:
    """Files and arguments of an upload; the arguments come from the query string.

    Raises
    ------
    Problem
        If the body is no multipart/form-data, or a part is missing, unknown or empty.
    """
    arguments = validated(RecordingArguments, sent.query.arguments())
    files: dict[str, list[bytes]] = {OBSERVATIONS: [], NAVIGATION: []}
    for part in read_parts(sent):
        if part.name not in files:
            raise invalid_value(
                part.name[:60] or "body", f"this part is not taken; send {OBSERVATIONS} and {NAVIGATION}"
            )
        files[part.name].append(part.content)
    if len(files[OBSERVATIONS]) != 1:
        found = "is missing" if not files[OBSERVATIONS] else "comes twice"
        raise invalid_value(OBSERVATIONS, f"{found}; send one part of this name, a RINEX file or a log")
    if not files[NAVIGATION]:
        raise invalid_value(
            NAVIGATION, "is missing; send the broadcast messages of the days observed as RINEX in this part"
        )
    return Recording(files[OBSERVATIONS][0], files[NAVIGATION]), arguments
