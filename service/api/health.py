"""``/healthz``, ``/readyz`` and ``/metrics``: what orchestrators and monitors ask."""

from __future__ import annotations

from fastapi import APIRouter, Request, Response
from fastapi.responses import PlainTextResponse

from service.errors import ProblemType
from service.observability.metrics import METRICS_MEDIA_TYPE, Metrics
from service.schemas.answers import HealthAnswer, ReadyAnswer
from service.schemas.problems import problem_responses
from service.warmth import Warmth

router = APIRouter(tags=["operations"])


@router.get("/healthz", summary="Is the process alive", operation_id="health")
async def health() -> HealthAnswer:
    """Answers as long as the process does."""
    return HealthAnswer(status="ok")


@router.get(
    "/readyz",
    summary="Does the service take work",
    operation_id="ready",
    responses=problem_responses(ProblemType.not_ready),
)
async def ready(request: Request) -> ReadyAnswer:
    """200 once no fit waits for a compiler, 503 until then.

    The usual fit is then answered at once; compiled code that only others need may still be read from its
    cache behind it, and one that comes first waits for that, for milliseconds.
    """
    warmth: Warmth = request.app.state.warmth
    if not warmth.is_ready:
        raise warmth.not_ready()
    return ReadyAnswer(status="ready", kernels=warmth.total, loaded=warmth.loaded)


@router.get(
    "/metrics",
    summary="Metrics for Prometheus",
    operation_id="metrics",
    response_class=PlainTextResponse,
    response_model=None,
    responses={200: {"content": {"text/plain": {"schema": {"type": "string"}}}, "description": "Metrics."}},
)
async def metrics(request: Request) -> Response:
    """Report counts, durations and queue depth in the text format of Prometheus."""
    counted: Metrics = request.app.state.metrics
    return Response(counted.exposition(), headers={"Content-Type": METRICS_MEDIA_TYPE})
