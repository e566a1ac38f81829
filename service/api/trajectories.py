"""``POST /v1/trajectories``: a GPS track in; a label per fix and the smoothed track out."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import APIRouter, Query, Request, Response

import estimators
from estimators.consensus.cancellation import cancelled_by
from service.api.computing import compute_answer, read_body, sent_by
from service.codecs.negotiation import media_type_of
from service.codecs.sent import Sent
from service.codecs.trajectories.registry import (
    READERS,
    UPLOAD,
    WRITERS,
    TrackReader,
    TrackWriter,
    choose_track_writer,
)
from service.compute import Patience
from service.errors import ProblemType
from service.observability.timing import Stopwatch
from service.schemas.answers import DescribedAnswer
from service.schemas.responses import computed_responses
from service.schemas.tracks import TrackAnswer, TrackMethodsAnswer, TracksAnswer
from service.schemas.trajectories import TrackQuery

router = APIRouter(prefix="/v1", tags=["trajectories"])

_BINARY = {"schema": {"type": "string", "format": "binary"}}
BODY_SCHEMAS: dict[str, dict[str, Any]] = {name: dict(_BINARY) for name in READERS} | {
    "application/json": {"schema": {"$ref": "#/components/schemas/TrackRequest"}},
    "text/csv": {
        "schema": {
            "type": "string",
            "description": "A header and one line per fix. Columns are known by their usual names, or named "
            "by `time_column` and its like.",
        },
    },
    UPLOAD: {
        "schema": {
            "type": "object",
            "required": ["file"],
            "properties": {
                "file": {
                    "type": "array",
                    "items": {"type": "string", "format": "binary"},
                    "description": "Track files: GPX, KML, KMZ, GeoJSON, FIT, NMEA, CSV, Parquet or Arrow, "
                    "plain or gzip, told by content. Several parts of this name are tracks of their own.",
                },
            },
        },
    },
}
ANSWER_SCHEMAS: dict[str, dict[str, Any]] = {
    writer.media_type: {"schema": {"type": "string"}} for writer in WRITERS if writer.name != "json"
} | {"application/geo+json": {"schema": {"$ref": "#/components/schemas/TrackFeaturesAnswer"}}}

RESPONSES = computed_responses(
    TrackAnswer | TracksAnswer,
    "The cleaned track, or with `device`, several files or several tracks in one the track of each, in the "
    "format asked for by `format` or `Accept`.",
    ANSWER_SCHEMAS,
    ProblemType.no_track,
    ProblemType.too_many_series,
)


@router.post(
    "/trajectories",
    summary="Clean a GPS track",
    operation_id="clean_trajectory",
    response_class=Response,
    response_model=None,
    responses=RESPONSES,
    openapi_extra={"requestBody": {"required": True, "content": BODY_SCHEMAS}},
)
async def clean(request: Request, query: Annotated[TrackQuery, Query()]) -> Response:
    """Say which fixes of a track lie, and where it really went.

    Fixes come as JSON columns with the arguments beside them, as a track file, or as an upload of several,
    with the arguments in the query string. Every fix gets a label, in the order they came. With `device` each
    device is cleaned by itself; one that cannot be cleaned has the reason, and the others their tracks.
    """
    headers = request.headers
    writer = choose_track_writer(headers.get("accept"), query.format)
    media_type = media_type_of(headers.get("content-type"), headers.get("content-encoding"), tuple(READERS))
    body = await read_body(request)
    watch = Stopwatch()

    def job(patience: Patience) -> tuple[bytes, int]:
        return answer(sent_by(request, body, query, patience), READERS[media_type], writer, watch, patience)

    return await compute_answer(request, writer, watch, job)


def answer(
    sent: Sent[TrackQuery], reader: TrackReader, writer: TrackWriter, watch: Stopwatch, patience: Patience
) -> tuple[bytes, int]:
    """Everything between a body and its answer; runs in a thread.

    Returns
    -------
    tuple of (bytes, int)
        The answer, and the number of fixes.

    Raises
    ------
    Problem
        If the body cannot be read or its fixes give no track.
    Cancelled
        If nobody waits any more.
    """
    # The readers of files are imported with the first of them.
    from service.trajectories.cleaned import clean_recorded  # noqa: PLC0415

    with watch.phase("parse"):
        recorded, arguments = reader.read(sent)
        writer.check(recorded)
    patience.check()
    with watch.phase("fit"), cancelled_by(patience.flag):
        cleaned = clean_recorded(recorded, arguments, lambda _done, _total: patience.check())
    patience.check()
    with watch.phase("encode"):
        return b"".join(writer.write(cleaned, sent.query)), len(recorded.recording)


@router.get(
    "/trajectory-methods", summary="List the methods of trajectories", operation_id="list_trajectory_methods"
)
async def list_trajectory_methods() -> TrackMethodsAnswer:
    """Every method of cleaning a track: what it does, when to use it, where it comes from."""
    rows = estimators.track_methods().values()
    return TrackMethodsAnswer(
        methods=[DescribedAnswer.model_validate(row, from_attributes=True) for row in rows]
    )
