"""``POST /v1/trends/batch``: many series in, a row for each out."""

from __future__ import annotations

import asyncio
import dataclasses
import time
from collections.abc import AsyncIterator, Callable, Iterator
from typing import Annotated, Any

import orjson
from fastapi import APIRouter, Query, Request, Response
from fastapi.responses import StreamingResponse

from estimators.consensus.cancellation import cancelled_by
from service.admission import Admission
from service.api.computing import read_body
from service.codecs.arguments import read_arguments
from service.codecs.batch.registry import (
    READERS,
    WRITERS,
    BatchReader,
    BatchWriter,
    choose_reader,
    choose_writer,
)
from service.codecs.csv import read_horizon
from service.codecs.limits import UNPACKED_PER_BODY, Limits
from service.compute import Compute, Patience
from service.errors import Problem, ProblemType
from service.observability.metrics import Metrics
from service.observability.timing import Stopwatch
from service.schemas.batch import BatchAnswer, BatchQuery
from service.schemas.responses import computed_responses
from service.settings import Settings

router = APIRouter(tags=["trends"])

_EXAMPLE = (
    "series,time,value\nnorth,0,1.0\nnorth,1,1.9\nnorth,2,3.1\nnorth,3,4.0\n"
    "south,0,9.0\nsouth,1,8.1\nsouth,2,6.9\nsouth,3,6.0\n"
)
_BINARY = {"schema": {"type": "string", "format": "binary"}}
BODY_SCHEMAS: dict[str, dict[str, Any]] = {name: dict(_BINARY) for name in READERS} | {
    "application/json": {"schema": {"$ref": "#/components/schemas/BatchRequest"}},
    "text/csv": {
        "schema": {
            "type": "string",
            "description": "A header and one line per row; columns `series`, `time`, `value` and optionally "
            "`weight`, `lat`, `lon`.",
        },
        "example": _EXAMPLE,
    },
}
ANSWER_SCHEMAS: dict[str, dict[str, Any]] = {
    writer.media_type: {"schema": {"type": "string"}} for writer in WRITERS if writer.name != "json"
}

RESPONSES = computed_responses(
    BatchAnswer,
    "One row per series, in the format asked for by `format` or `Accept`; a series without a trend is a row "
    "with its reason. A streamed answer (NDJSON) that cannot be finished ends with a line that is a problem.",
    ANSWER_SCHEMAS,
    ProblemType.too_many_series,
    timing="Milliseconds of the phases parse, queue, fit and encode, as far as they are over when the answer "
    "begins.",
)

Emit = Callable[[bytes], None]
Job = Callable[[Patience, Emit], int]


@router.post(
    "/v1/trends/batch",
    summary="Fit robust trends to many series",
    operation_id="fit_trends",
    response_class=Response,
    response_model=None,
    responses=RESPONSES,
    openapi_extra={"requestBody": {"required": True, "content": BODY_SCHEMAS}},
)
async def fit_batch(request: Request, query: Annotated[BatchQuery, Query()]) -> Response:
    """Fit a robust trend to every series of a long table.

    The table comes as JSON columns, CSV, Arrow IPC or Parquet; the arguments of the fit are query
    parameters for all of them. Rows of a series need not stand together.
    """
    headers = request.headers
    writer = choose_writer(headers.get("accept"), query.format)
    reader = choose_reader(headers.get("content-type"), headers.get("content-encoding"))
    body = await read_body(request)
    watch = Stopwatch()
    job = _job(request, query, body, reader, writer, watch)
    await request.app.state.warmth.wait(request.app.state.settings.queue_seconds)
    if writer.is_streamed:
        return await _streamed(request, job, writer, watch)
    pieces: list[bytes] = []
    compute: Compute = request.app.state.compute
    points = await compute.run(lambda patience: job(patience, pieces.append), request.receive(), watch)
    _count(request, points, watch)
    return Response(b"".join(pieces), headers=_headers(watch), media_type=writer.content_type)


def _job(
    request: Request,
    query: BatchQuery,
    body: bytes,
    reader: BatchReader,
    writer: BatchWriter,
    watch: Stopwatch,
) -> Job:
    """Everything between a body and its answer, to be run in a thread; returns the number of rows."""
    settings: Settings = request.app.state.settings
    admission: Admission = request.app.state.admission
    arguments = read_arguments(query.fit_arguments())

    def job(patience: Patience, emit: Emit) -> int:
        # Arrow is imported with the first batch; single series do not wait for it.
        import pyarrow as pa  # noqa: PLC0415

        from service.batches import answer_batch  # noqa: PLC0415
        from service.codecs.batch.rows import Reading  # noqa: PLC0415

        limits = Limits(settings.max_points, settings.max_series, UNPACKED_PER_BODY * settings.max_body_bytes)
        with watch.phase("parse"):
            reading = Reading(query.columns(), arguments.time_unit, limits, patience.check)
            batch = reader.read(pa.BufferReader(body), reading)
            horizon = None
            if query.horizon is not None:
                horizon = read_horizon(query.horizon, arguments.time_unit, batch.form)
        # Slots that nobody uses now; how many threads fit changes no byte of the answer.
        idle = settings.workers - admission.running
        answer = answer_batch(
            batch,
            arguments,
            horizon=horizon,
            points=query.points,
            threads=1 + max(0, idle),
            progress=lambda _done, _total: patience.check(),
        )
        with cancelled_by(patience.flag):
            for piece in _timed(writer.write, answer, watch):
                emit(piece)
                patience.check()
        return int(batch.offsets[-1])

    return job


def _timed(write: Callable[[Any], Iterator[bytes]], answer: Any, watch: Stopwatch) -> Iterator[bytes]:
    """Pieces of an answer; the time of its parts is the phase ``fit``, the rest ``encode``."""
    fitting = 0.0
    start = time.perf_counter()

    def fitted() -> Iterator[Any]:
        nonlocal fitting
        parts = iter(answer.parts)
        while True:
            begun = time.perf_counter()
            part = next(parts, None)
            fitting += time.perf_counter() - begun
            if part is None:
                return
            yield part

    yield from write(dataclasses.replace(answer, parts=fitted()))
    watch.seconds["fit"] = fitting
    watch.seconds["encode"] = time.perf_counter() - start - fitting


async def _streamed(request: Request, job: Job, writer: BatchWriter, watch: Stopwatch) -> Response:
    """Answer that begins with its first piece; what is wrong before that is an ordinary problem."""
    loop = asyncio.get_running_loop()
    pieces: asyncio.Queue[bytes | None] = asyncio.Queue()
    compute: Compute = request.app.state.compute

    def emit(piece: bytes) -> None:
        loop.call_soon_threadsafe(pieces.put_nowait, piece)

    running = asyncio.ensure_future(
        compute.run(lambda patience: job(patience, emit), request.receive(), watch)
    )
    running.add_done_callback(lambda _: pieces.put_nowait(None))
    try:
        first = await pieces.get()
    except asyncio.CancelledError:
        running.cancel()
        raise
    if first is None:
        await running
    follow = _pieces(request, first, pieces, running, watch)
    return StreamingResponse(follow, headers=_headers(watch), media_type=writer.content_type)


async def _pieces(
    request: Request,
    first: bytes | None,
    pieces: asyncio.Queue[bytes | None],
    running: asyncio.Future[int],
    watch: Stopwatch,
) -> AsyncIterator[bytes]:
    try:
        piece = first
        while piece is not None:
            yield piece
            piece = await pieces.get()
        _count(request, await running, watch)
    except Problem as problem:
        # The status has been sent; the last line says that rows are missing, and why.
        yield orjson.dumps(problem.to_dict(request.state.request_id), option=orjson.OPT_APPEND_NEWLINE)
    finally:
        running.cancel()


def _count(request: Request, points: int, watch: Stopwatch) -> None:
    metrics: Metrics = request.app.state.metrics
    metrics.count_fit(points, watch.seconds)
    request.state.points = points


def _headers(watch: Stopwatch) -> dict[str, str]:
    return {"Server-Timing": watch.server_timing(), "Vary": "Accept"}
