"""From a body to an answer that a thread computes: what the routes of single answers share."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from fastapi import Request, Response

from service.codecs.limits import UNPACKED_PER_BODY, Limits
from service.codecs.offers import Offer
from service.codecs.sent import Sent
from service.compute import Compute, Patience
from service.errors import Problem, ProblemType
from service.observability.metrics import Metrics
from service.observability.timing import Stopwatch
from service.security.headers import PICTURE_POLICY
from service.settings import Settings

Query = TypeVar("Query")


async def read_body(request: Request) -> bytes:
    """Read the body of a request.

    Raises
    ------
    Problem
        If there is nothing in it.
    """
    body = await request.body()
    if not body or body.isspace():
        raise Problem(ProblemType.empty_body)
    return body


def sent_by(request: Request, body: bytes, query: Query, patience: Patience) -> Sent[Query]:
    """Put a body together with what bounds its reading."""
    settings: Settings = request.app.state.settings
    limits = Limits(settings.max_points, settings.max_series, UNPACKED_PER_BODY * settings.max_body_bytes)
    return Sent(body, request.headers.get("content-type", ""), query, limits, patience.check)


async def compute_answer(
    request: Request, form: Offer[Any], watch: Stopwatch, job: Callable[[Patience], tuple[bytes, int]]
) -> Response:
    """Run a job in a thread once the service is ready, and send and count what it gives.

    Parameters
    ----------
    request : Request
    form : Offer
        Form of the answer.
    watch : Stopwatch
        Of the phases; the job's own are told to it.
    job : callable
        Gives the answer and the number of its rows.

    Raises
    ------
    Problem
        If the service is not ready or too busy, or the job raises it.
    """
    state = request.app.state
    compute: Compute = state.compute
    metrics: Metrics = state.metrics
    await state.warmth.wait(state.settings.queue_seconds)
    content, rows = await compute.run(job, request.receive(), watch)
    metrics.count_fit(rows, watch.seconds)
    request.state.points = rows
    headers = {"Server-Timing": watch.server_timing(), "Vary": "Accept"}
    if form.name == "svg":
        headers["Content-Security-Policy"] = PICTURE_POLICY
    return Response(content, headers=headers, media_type=form.content_type)
