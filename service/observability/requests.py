"""Around every request: its id, its access line, its count. Pure ASGI, so that it costs microseconds."""

from __future__ import annotations

import re
import secrets
import time

from starlette.datastructures import Headers, MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send
from structlog.typing import FilteringBoundLogger

from service.observability.metrics import Metrics

REQUEST_ID_HEADER = "x-request-id"

#: An id from outside is kept if it is a plain token; anything else could forge lines of a log.
_TOKEN = re.compile(r"[A-Za-z0-9._-]{1,64}")

READINESS_PATH = "/readyz"
_LONGEST_PATH = 200


class ObserveRequests:
    """ASGI middleware that numbers, logs and counts requests.

    Parameters
    ----------
    app : ASGI application
    metrics : Metrics
    log : structlog logger
    """

    def __init__(self, app: ASGIApp, metrics: Metrics, log: FilteringBoundLogger) -> None:
        self._app = app
        self._metrics = metrics
        self._log = log

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a request on, then log and count it."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        start = time.perf_counter()
        given = Headers(scope=scope).get(REQUEST_ID_HEADER, "")
        request_id = given if _TOKEN.fullmatch(given) else secrets.token_hex(8)
        state = scope.setdefault("state", {})
        state["request_id"] = request_id
        # What is answered if the app raises: the 500 is sent outside of this middleware.
        status = 500

        async def send_with_id(message: Message) -> None:
            nonlocal status
            if message["type"] == "http.response.start":
                status = message["status"]
                MutableHeaders(scope=message)[REQUEST_ID_HEADER] = request_id
            await send(message)

        try:
            await self._app(scope, receive, send_with_id)
        finally:
            seconds = time.perf_counter() - start
            route = getattr(scope.get("route"), "path", "unmatched")
            self._metrics.count_request(route, scope["method"], status, seconds)
            # That it is not ready yet is what /readyz is asked for, and no failure.
            failed = status >= 500 and not (status == 503 and route == READINESS_PATH)
            write = self._log.error if failed else self._log.info
            write(
                "request",
                request_id=request_id,
                method=scope["method"][:20],
                path=scope["path"][:_LONGEST_PATH],
                status=status,
                ms=round(1e3 * seconds, 3),
                **({"points": state["points"]} if "points" in state else {}),
            )
