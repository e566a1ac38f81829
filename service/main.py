"""The service put together: settings in, an ASGI application out; and the way to serve it.

Around the routes stand four small ASGI middlewares, from the outside in: observe (id, log, count), security
headers, body limits, API key. All state hangs on the app, so that several can live in one process.
"""

from __future__ import annotations

import functools
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

import uvicorn
from fastapi import FastAPI, Request, Response
from fastapi.exceptions import RequestValidationError
from starlette.exceptions import HTTPException
from starlette.middleware import Middleware
from starlette.middleware.cors import CORSMiddleware
from starlette.requests import ClientDisconnect

from service.admission import Admission, BodyBudget, LimitBodies
from service.api import batch, catalogue, docs, health, live_tracks, positions, trajectories, trends
from service.codecs.arguments import from_validation
from service.compute import Compute
from service.errors import Problem, ProblemType
from service.observability.logs import make_logger, uvicorn_log_config
from service.observability.metrics import Metrics
from service.observability.requests import ObserveRequests
from service.openapi import describe
from service.security.headers import SECURITY_HEADERS, SecurityHeaders
from service.security.keys import RequireKey
from service.settings import Settings, load_settings
from service.warmth import Warmth

#: What web servers log for a caller who left before the answer; it is never sent.
CLIENT_CLOSED_REQUEST = 499


def create_app(settings: Settings | None = None) -> FastAPI:
    """Put the service together as an ASGI application.

    Parameters
    ----------
    settings : Settings, optional
        Default: from the environment (``PLUMBLINE_*``).

    Returns
    -------
    FastAPI

    Raises
    ------
    SettingsError
        If the environment asks for what the service refuses, such as a public address without an API key.

    Examples
    --------
    >>> app = create_app(Settings())
    >>> sorted(path for path in app.openapi()["paths"])[:2]
    ['/healthz', '/metrics']
    """
    settings = load_settings() if settings is None else settings
    log = make_logger(settings)
    admission = Admission(settings)
    budget = BodyBudget(settings.max_buffered_bytes)
    metrics = Metrics(
        running=lambda: admission.running, waiting=lambda: admission.waiting, buffered=lambda: budget.used
    )

    @asynccontextmanager
    async def lifespan(app: FastAPI) -> AsyncIterator[None]:
        app.state.compute = compute = Compute(settings, admission)
        app.state.warmth = warmth = Warmth(log)
        warmth.start()
        yield
        warmth.stop()
        compute.close()

    middleware = [
        Middleware(ObserveRequests, metrics=metrics, log=log),
        Middleware(SecurityHeaders, shared=bool(settings.allowed_origins())),
    ]
    if settings.allowed_origins():
        middleware.append(_cors(settings))
    middleware += [
        Middleware(LimitBodies, settings=settings, budget=budget),
        Middleware(RequireKey, keys=settings.keys()),
    ]
    app = FastAPI(
        title="Plumbline",
        docs_url=None,
        redoc_url=None,
        redirect_slashes=False,
        lifespan=lifespan,
        middleware=middleware,
    )
    app.state.settings = settings
    app.state.metrics = metrics
    app.state.admission = admission
    for part in (trends, batch, positions, trajectories, live_tracks, catalogue, health, docs):
        app.include_router(part.router)
    _answer_errors(app)
    # Made when it is asked for: the first fit does not wait for it.
    app.openapi = functools.cache(lambda: describe(app))  # type: ignore[method-assign]
    return app


def server_config(settings: Settings) -> uvicorn.Config:
    """Configure a server for the service; on a signal it finishes the requests that run and stops.

    Parameters
    ----------
    settings : Settings

    Returns
    -------
    uvicorn.Config
        For ``uvicorn.Server``.
    """
    return uvicorn.Config(
        create_app(settings),
        host=settings.host,
        port=settings.port,
        log_config=uvicorn_log_config(settings),
        access_log=False,
        server_header=False,
        limit_concurrency=settings.max_connections,
        timeout_graceful_shutdown=round(settings.deadline_seconds) + 1,
    )


def _cors(settings: Settings) -> Middleware:
    return Middleware(
        CORSMiddleware,
        allow_origins=settings.allowed_origins(),
        allow_methods=["GET", "POST"],
        allow_headers=["authorization", "content-type", "x-api-key", "x-request-id"],
        expose_headers=["server-timing", "x-request-id", "retry-after"],
    )


def _answer_errors(app: FastAPI) -> None:
    """Make every error of the framework a problem."""

    def request_id(request: Request) -> str:
        return str(getattr(request.state, "request_id", ""))

    @app.exception_handler(Problem)
    async def of_ours(request: Request, problem: Problem) -> Response:
        return problem.to_response(request_id(request))

    @app.exception_handler(RequestValidationError)
    async def of_validation(request: Request, error: RequestValidationError) -> Response:
        return from_validation(error.errors(), skip=1).to_response(request_id(request))

    @app.exception_handler(HTTPException)
    async def of_framework(request: Request, error: HTTPException) -> Response:
        kinds = {404: ProblemType.not_found, 405: ProblemType.method_not_allowed}
        kind = kinds.get(error.status_code, ProblemType.malformed_body)
        return Problem(kind, headers=error.headers).to_response(request_id(request))

    @app.exception_handler(ClientDisconnect)
    async def of_nobody(_request: Request, _error: ClientDisconnect) -> Response:
        return Response(status_code=CLIENT_CLOSED_REQUEST)

    @app.exception_handler(Exception)
    async def of_anything(request: Request, _error: Exception) -> Response:
        # Answered outside of the middlewares, so their headers are set here.
        response = Problem(ProblemType.internal_error).to_response(request_id(request))
        response.headers.update({"x-request-id": request_id(request), **SECURITY_HEADERS})
        return response
