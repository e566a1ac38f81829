"""``POST /v1/trends``: one series in, its robust trend out."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import APIRouter, Query, Request, Response

from estimators import InputError, NoFit, RobustOptions, Trend, fit_trend
from estimators.consensus.cancellation import cancelled_by
from estimators.notices import notice_to_dict
from estimators.result import NoFitReason
from service.api.computing import compute_answer, read_body
from service.codecs.columns import Columns
from service.codecs.limits import check_columns
from service.codecs.registry import WRITERS, Read, Writer, choose_reader, choose_writer
from service.compute import Patience
from service.errors import FieldError, Problem, ProblemType, invalid_value
from service.observability.timing import Stopwatch
from service.schemas.answers import TrendAnswer
from service.schemas.options import FitArguments, TrendOptions, TrendQuery
from service.schemas.responses import computed_responses
from service.settings import Settings

router = APIRouter(tags=["trends"])

#: The library's arguments by the names they have on the wire.
WIRE_NAMES = {"t": "time", "y": "value", "weights": "weight"} | {
    name: f"options.{name}" for name in TrendOptions.model_fields
}

BODY_SCHEMAS: dict[str, dict[str, Any]] = {
    "application/json": {"schema": {"$ref": "#/components/schemas/TrendRequest"}},
    "text/csv": {
        "schema": {
            "type": "string",
            "description": "A header and one line per row; columns `time`, `value` and optionally `weight`.",
        },
        "example": "time,value\n2020-01-01,1.0\n2021-01-01,1.9\n2022-01-01,3.1\n2023-01-01,4.0\n",
    },
}
ANSWER_SCHEMAS: dict[str, dict[str, Any]] = {
    writer.media_type: {"schema": {"type": "string"}} for writer in WRITERS if writer.name != "json"
}

RESPONSES = computed_responses(
    TrendAnswer,
    "The trend, in the format asked for by `format` or `Accept`.",
    ANSWER_SCHEMAS,
    ProblemType.no_fit,
)


@router.post(
    "/v1/trends",
    summary="Fit a robust trend",
    operation_id="fit_trend",
    response_class=Response,
    response_model=None,
    responses=RESPONSES,
    openapi_extra={"requestBody": {"required": True, "content": BODY_SCHEMAS}},
)
async def fit(request: Request, query: Annotated[TrendQuery, Query()]) -> Response:
    """Fit a robust trend to a time series and label every row.

    The series comes as JSON columns, with the arguments of the fit beside them, or as CSV, with the
    arguments in the query string. Times in the answer are written in the form they came.
    """
    headers = request.headers
    writer = choose_writer(headers.get("accept"), query.format)
    reader = choose_reader(headers.get("content-type"), headers.get("content-encoding"))
    body = await read_body(request)
    settings: Settings = request.app.state.settings
    watch = Stopwatch()

    def job(patience: Patience) -> tuple[bytes, int]:
        return answer(body, reader, writer, query, settings.max_points, watch, patience)

    return await compute_answer(request, writer, watch, job)


def answer(
    body: bytes,
    reader: Read,
    writer: Writer,
    query: TrendQuery,
    max_points: int,
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
        If the body cannot be read or its data give no trend.
    Cancelled
        If nobody waits any more.
    """
    with watch.phase("parse"):
        columns, arguments = reader(body, query)
        check_columns(columns, max_points)
    patience.check()
    with watch.phase("fit"), cancelled_by(patience.flag):
        trend = fit_columns(columns, arguments)
    patience.check()
    with watch.phase("encode"):
        return writer.write(trend, columns, query), int(columns.time.size)


def fit_columns(columns: Columns, arguments: FitArguments) -> Trend:
    """Trend of a series as it came.

    Raises
    ------
    Problem
        422 if the library refuses an argument or finds no trend.
    """
    try:
        found = fit_trend(
            columns.time,
            columns.value,
            model=arguments.model,
            method=arguments.method,
            threshold=arguments.threshold,
            sigma=arguments.sigma,
            weights=columns.weight,
            level=arguments.level,
            seed=arguments.seed,
            uncertainty=arguments.uncertainty,
            noise=arguments.noise,
            degree=arguments.degree,
            seasonal=arguments.seasonal,
            harmonics=arguments.harmonics,
            columns=columns.own or None,
            regime=arguments.regime,
            reach=arguments.reach,
            horizon=columns.horizon,
            predict=columns.predict,
            options=RobustOptions(**arguments.options.model_dump()),
        )
    except InputError as error:
        raise invalid_value(WIRE_NAMES.get(error.field, error.field), error.message) from error
    if isinstance(found, NoFit):
        raise no_fit(found)
    return found


def no_fit(found: NoFit) -> Problem:
    """Problem of data that do not determine a trend."""
    return Problem(
        ProblemType.no_fit,
        found.message,
        errors=[FieldError("time" if found.reason is NoFitReason.constant_time else "value", found.message)],
        extra={
            "reason": found.reason.value,
            "points": {"reason": found.points.reason},
            "notices": [notice_to_dict(item) for item in found.notices],
        },
    )
