"""Sending track files to a server, for the tests of what comes back."""

from __future__ import annotations

from typing import Any

import httpx2

from tests.service.fixes import clock, walk
from tests.service.server import Server


def post(server: Server, content: bytes, media_type: str, **params: Any) -> httpx2.Response:
    return httpx2.post(
        f"{server.url}/v1/trajectories",
        content=content,
        params=params,
        headers={"content-type": media_type},
        timeout=60,
    )


def upload(server: Server, *files: tuple[str, bytes], part: str = "file", **params: Any) -> httpx2.Response:
    return httpx2.post(
        f"{server.url}/v1/trajectories", files=[(part, file) for file in files], params=params, timeout=60
    )


def timed_walk() -> dict[str, Any]:
    return walk(time=clock())
