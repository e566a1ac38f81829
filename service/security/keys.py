"""API keys: closed unless a path is listed as open, compared in constant time."""

from __future__ import annotations

import hashlib
import hmac
from collections.abc import Sequence

from starlette.datastructures import Headers
from starlette.types import ASGIApp, Receive, Scope, Send

from service.errors import Problem, ProblemType

#: Paths without a key: what probes and people read before they have one. None tells anything about data.
OPEN_PATHS = frozenset({"/", "/healthz", "/readyz", "/openapi.json", "/docs", "/docs/style.css"})
OPEN_PREFIX = "/problems/"


class RequireKey:
    """ASGI middleware that asks for an API key.

    Parameters
    ----------
    app : ASGI application
    keys : sequence of str
        Keys in force; only their digests are kept. Without any, every request passes.
    """

    def __init__(self, app: ASGIApp, keys: Sequence[str]) -> None:
        self._app = app
        self._digests = tuple(_digest(key) for key in keys)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a request on if it carries a key or needs none."""
        if scope["type"] != "http" or not self._digests or is_open(scope["path"]):
            await self._app(scope, receive, send)
            return
        if self._knows(_key_of(Headers(scope=scope))):
            await self._app(scope, receive, send)
            return
        problem = Problem(
            ProblemType.authentication_required, headers={"WWW-Authenticate": 'Bearer realm="plumbline"'}
        )
        await problem.to_response(scope["state"]["request_id"])(scope, receive, send)

    def _knows(self, key: str) -> bool:
        # Every digest is compared, whatever the first ones say, so that time tells nothing about the keys.
        digest = _digest(key)
        matches = [hmac.compare_digest(digest, known) for known in self._digests]
        return any(matches)


def is_open(path: str) -> bool:
    """Whether a path needs no key."""
    return path in OPEN_PATHS or path.startswith(OPEN_PREFIX)


def _key_of(headers: Headers) -> str:
    scheme, _, credentials = headers.get("authorization", "").partition(" ")
    if scheme.lower() == "bearer":
        return credentials.strip()
    return headers.get("x-api-key", "")


def _digest(key: str) -> bytes:
    return hashlib.sha256(key.encode("utf-8")).digest()
