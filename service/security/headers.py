"""Headers that tell browsers to do nothing they need not do with our answers."""

from __future__ import annotations

from collections.abc import Mapping

from starlette.datastructures import MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

_CLOSED = "frame-ancestors 'none'; base-uri 'none'; form-action 'none'"

#: An answer is data: nothing in it may load, run, be framed, be guessed at or be kept.
SECURITY_HEADERS: Mapping[str, str] = {
    "content-security-policy": f"default-src 'none'; {_CLOSED}",
    "x-content-type-options": "nosniff",
    "referrer-policy": "no-referrer",
    "cross-origin-resource-policy": "same-origin",
    "cache-control": "no-store",
}

#: The documentation page needs its own style sheet and nothing else.
PAGE_POLICY = f"default-src 'none'; style-src 'self'; {_CLOSED}"

#: A picture carries its colours in style attributes.
PICTURE_POLICY = f"default-src 'none'; style-src 'unsafe-inline'; img-src data:; {_CLOSED}"


class SecurityHeaders:
    """ASGI middleware that adds :data:`SECURITY_HEADERS` where an answer does not set its own.

    Parameters
    ----------
    app : ASGI application
    shared : bool
        Whether pages of other origins may read the answers (CORS is on).
    """

    def __init__(self, app: ASGIApp, shared: bool = False) -> None:
        self._app = app
        self._headers = dict(SECURITY_HEADERS)
        if shared:
            self._headers["cross-origin-resource-policy"] = "cross-origin"

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a request on and complete the headers of its answer."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return

        async def send_with_headers(message: Message) -> None:
            if message["type"] == "http.response.start":
                headers = MutableHeaders(scope=message)
                for name, value in self._headers.items():
                    headers.setdefault(name, value)
            await send(message)

        await self._app(scope, receive, send_with_headers)
