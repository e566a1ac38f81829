"""``POST /v1/trajectories/live``: the next rows of a track in; what is settled now, and the state, out."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query, Request, Response

from service.api.computing import compute_answer, read_body, sent_by
from service.codecs.negotiation import media_type_of
from service.codecs.offers import Offer, choose_offer
from service.codecs.sent import Sent
from service.compute import Patience
from service.observability.timing import Stopwatch
from service.schemas.live_tracks import LiveAnswer, LiveQuery
from service.schemas.responses import computed_responses

router = APIRouter(prefix="/v1", tags=["trajectories"])

JSON = "application/json"
_JSON_ANSWER: Offer[str] = Offer("json", JSON, JSON)
"""The one form of the answer."""


@router.post(
    "/trajectories/live",
    summary="Clean a GPS track while it is recorded",
    operation_id="clean_live",
    response_class=Response,
    response_model=None,
    responses=computed_responses(LiveAnswer, "What is settled now, what waits, and the state.", {}),
    openapi_extra={
        "requestBody": {
            "required": True,
            "content": {JSON: {"schema": {"$ref": "#/components/schemas/LiveRequest"}}},
        }
    },
)
async def clean(request: Request, query: Annotated[LiveQuery, Query()]) -> Response:
    """Take the rows of one receiver that have come since the last call; settle those that can be.

    The service keeps nothing: send the `state` of the last answer along. A row is settled, its answer
    final, when at most `lag` later ones are known, and what settled rows say does not depend on how the
    rows were cut into calls.
    """
    headers = request.headers
    form = choose_offer([_JSON_ANSWER], headers.get("accept"), query.format)
    media_type_of(headers.get("content-type"), headers.get("content-encoding"), [JSON])
    body = await read_body(request)
    watch = Stopwatch()

    def job(patience: Patience) -> tuple[bytes, int]:
        return answer(sent_by(request, body, query, patience), watch)

    return await compute_answer(request, form, watch, job)


def answer(sent: Sent[LiveQuery], watch: Stopwatch) -> tuple[bytes, int]:
    """Everything between a body and its answer; runs in a thread.

    Returns
    -------
    tuple of (bytes, int)
        The answer, and the number of rows.

    Raises
    ------
    Problem
        If the body cannot be read, or the state or an argument is refused.
    Cancelled
        If nobody waits any more.
    """
    # Readers and the cleaning of tracks are imported with the first of them.
    from service.codecs.trajectories.live import read_live_rows, write_live_rows  # noqa: PLC0415
    from service.trajectories.live import clean_more  # noqa: PLC0415

    with watch.phase("parse"):
        fixes, arguments = read_live_rows(sent)
    with watch.phase("fit"):
        cleaned = clean_more(fixes, arguments, sent.check)
    sent.check()
    with watch.phase("encode"):
        return write_live_rows(cleaned), fixes.time.size
