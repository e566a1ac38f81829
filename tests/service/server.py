"""A real uvicorn server in a thread, on a port of its own."""

from __future__ import annotations

import contextlib
import socket
import threading
import time
from collections.abc import Iterator
from dataclasses import dataclass

import uvicorn
from fastapi import FastAPI

from service.main import create_app
from service.settings import Settings


@dataclass(frozen=True)
class Server:
    """Where a server listens, and the app it serves."""

    port: int
    app: FastAPI

    @property
    def url(self) -> str:
        return f"http://127.0.0.1:{self.port}"

    def connect(self) -> socket.socket:
        """A bare connection, for requests that no client would send."""
        return socket.create_connection(("127.0.0.1", self.port), timeout=20)


@contextlib.contextmanager
def serve(**settings: object) -> Iterator[Server]:
    """Serve an app with some settings for as long as the block lasts."""
    app = create_app(Settings(**{"log_level": "error", **settings}))  # type: ignore[arg-type]
    server = uvicorn.Server(uvicorn.Config(app, port=0, log_config=None, access_log=False))
    thread = threading.Thread(target=server.run)
    thread.start()
    try:
        give_up = time.monotonic() + 60
        while not server.started and thread.is_alive() and time.monotonic() < give_up:
            time.sleep(0.005)
        assert server.started
        yield Server(server.servers[0].sockets[0].getsockname()[1], app)
    finally:
        server.should_exit = True
        thread.join(60)
    assert not thread.is_alive()
