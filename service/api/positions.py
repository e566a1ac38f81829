"""``POST /v1/positions``: pseudoranges in, the position out, and which satellites lie."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import APIRouter, Query, Request, Response

import estimators
from estimators.consensus.cancellation import cancelled_by
from service.api.computing import compute_answer, read_body, sent_by
from service.codecs.negotiation import media_type_of
from service.codecs.positions.pictures import check_picture
from service.codecs.positions.registry import (
    READERS,
    UPLOAD,
    WRITERS,
    PositionWriter,
    RangeReader,
    choose_position_writer,
)
from service.codecs.sent import Sent
from service.compute import Patience
from service.errors import ProblemType
from service.observability.timing import Stopwatch
from service.schemas.answers import MethodAnswer
from service.schemas.fixes import PositionAnswer, PositionMethodsAnswer, PositionsAnswer
from service.schemas.position_query import PositionQuery
from service.schemas.responses import computed_responses

router = APIRouter(prefix="/v1", tags=["positions"])

_BINARY = {"schema": {"type": "string", "format": "binary"}}
BODY_SCHEMAS: dict[str, dict[str, Any]] = {name: dict(_BINARY) for name in READERS} | {
    "application/json": {"schema": {"$ref": "#/components/schemas/PositionRequest"}},
    "text/csv": {
        "schema": {
            "type": "string",
            "description": "A header and one line per satellite and epoch; columns are named as the keys of "
            "a JSON body, those of other names are left alone. The arguments come in the query, `rotated` "
            "among them.",
        },
    },
    UPLOAD: {
        "schema": {
            "type": "object",
            "required": ["observations", "navigation"],
            "properties": {
                "observations": {
                    "type": "string",
                    "format": "binary",
                    "description": "RINEX 2 or 3 observations, plain, gzip or Hatanaka-compressed, or an "
                    "Android GnssLogger log; told by content.",
                },
                "navigation": {
                    "type": "array",
                    "items": {"type": "string", "format": "binary"},
                    "description": "RINEX 2 or 3 navigation files of the same days, plain or gzip; several "
                    "parts of this name are taken together.",
                },
            },
        },
    },
}
ANSWER_SCHEMAS: dict[str, dict[str, Any]] = {
    writer.media_type: {"schema": {"type": "string"}} for writer in WRITERS if writer.name != "json"
} | {
    "application/geo+json": {
        "schema": {
            "anyOf": [
                {"$ref": "#/components/schemas/FeatureAnswer"},
                {"$ref": "#/components/schemas/FeatureCollectionAnswer"},
            ]
        }
    }
}

RESPONSES = computed_responses(
    PositionAnswer | PositionsAnswer,
    "The position, or with `time` the positions, in the format asked for by `format` or `Accept`.",
    ANSWER_SCHEMAS,
    ProblemType.no_position,
    ProblemType.not_installed,
)


@router.post(
    "/positions",
    summary="Find a position and the satellites that lie",
    operation_id="locate",
    response_class=Response,
    response_model=None,
    responses=RESPONSES,
    openapi_extra={"requestBody": {"required": True, "content": BODY_SCHEMAS}},
)
async def find(request: Request, query: Annotated[PositionQuery, Query()]) -> Response:
    """Find the position of a receiver from pseudoranges, with faulty satellites left out.

    Ranges come as JSON columns with the arguments beside them, as a table (CSV, Arrow IPC, Parquet) or as
    the files of a receiver (multipart/form-data), with the arguments in the query string. Without `time`
    all rows of a table are one epoch; with it, rows of equal time are an epoch, and epochs are solved
    together. A position that is `ambiguous` should not be used alone.
    """
    headers = request.headers
    writer = choose_position_writer(headers.get("accept"), query.format)
    media_type = media_type_of(headers.get("content-type"), headers.get("content-encoding"), tuple(READERS))
    reader = READERS[media_type]
    body = await read_body(request)
    watch = Stopwatch()

    def job(patience: Patience) -> tuple[bytes, int]:
        return answer(sent_by(request, body, query, patience), reader, writer, watch, patience)

    return await compute_answer(request, writer, watch, job)


def answer(
    sent: Sent[PositionQuery],
    reader: RangeReader,
    writer: PositionWriter,
    watch: Stopwatch,
    patience: Patience,
) -> tuple[bytes, int]:
    """Everything between a body and its answer; runs in a thread.

    Returns
    -------
    tuple of (bytes, int)
        The answer, and the number of rows.

    Raises
    ------
    Problem
        If the body cannot be read or its ranges give no position.
    Cancelled
        If nobody waits any more.
    """
    with watch.phase("parse"):
        prepared = reader.read(sent)
        if writer.is_picture:
            check_picture(sent.query, many=prepared.is_series)
    patience.check()
    with watch.phase("fit"), cancelled_by(patience.flag):
        located = prepared.locate(lambda _done, _total: patience.check())
    patience.check()
    with watch.phase("encode"):
        return writer.write(located, sent.query), prepared.rows


@router.get(
    "/position-methods", summary="List the methods of positions", operation_id="list_position_methods"
)
async def list_position_methods() -> PositionMethodsAnswer:
    """Every method of fault exclusion: what it does, when to use it, where it comes from."""
    rows = estimators.position_methods().values()
    return PositionMethodsAnswer(
        methods=[MethodAnswer.model_validate(row, from_attributes=True) for row in rows]
    )
