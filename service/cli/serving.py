"""``plumbline serve``: warm the kernels, listen, and say where and how to ask."""

from __future__ import annotations

import gc
import socket
from collections.abc import Callable

import uvicorn

from service.cli.streams import answers, fail
from service.cli.warming import compile_missing
from service.main import create_app
from service.observability.logs import uvicorn_log_config
from service.settings import Settings, SettingsError, load_settings

_EXAMPLE = '{"time":[0,1,2,3,4,5,6,7],"value":[1.0,3.1,4.9,7.0,40.0,11.1,12.9,15.0]}'


def run_server(host: str | None, port: int | None) -> None:
    """Serve until interrupted.

    Parameters
    ----------
    host, port : str and int, or None
        Take precedence over ``PLUMBLINE_HOST`` and ``PLUMBLINE_PORT``. Port 0 takes any free one.
    """
    try:
        settings = load_settings(host=host, port=port)
    except SettingsError as error:
        fail(f"{error}.")
    listener = _listen(settings)
    compile_missing(settings)
    config = uvicorn.Config(
        create_app(settings),
        log_config=uvicorn_log_config(settings),
        access_log=False,
        server_header=False,
        limit_concurrency=settings.max_connections,
        timeout_graceful_shutdown=round(settings.deadline_seconds) + 1,
    )
    server = _AnnouncingServer(config, lambda: _announce(settings, listener))
    # The command turned collection off for the start; what is there by now is never garbage.
    gc.freeze()
    gc.enable()
    try:
        server.run(sockets=[listener])
    except KeyboardInterrupt:
        answers().print("Stopped.")


class _AnnouncingServer(uvicorn.Server):
    """A server that calls back once it takes requests, and not before."""

    def __init__(self, config: uvicorn.Config, announce: Callable[[], None]) -> None:
        super().__init__(config)
        self._announce = announce

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        await super().startup(sockets=sockets)
        if self.started:
            self._announce()


def _listen(settings: Settings) -> socket.socket:
    """Take the port before anything is compiled, so that one in use is told at once.

    Nobody is let in yet: until the server listens, connections are refused and not left to hang.
    """
    listener = socket.socket(socket.AF_INET6 if ":" in settings.host else socket.AF_INET)
    try:
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.bind((settings.host, settings.port))
    except OSError as error:
        listener.close()
        reason = error.strerror or str(error)
        fail(f"cannot listen on {settings.host} port {settings.port} ({reason}); choose another with --port.")
    return listener


def _announce(settings: Settings, listener: socket.socket) -> None:
    """Print the address and a line that works when pasted."""
    port = listener.getsockname()[1]
    reachable = {"0.0.0.0": "127.0.0.1", "::": "::1"}.get(settings.host, settings.host)
    address = f"http://{f'[{reachable}]' if ':' in reachable else reachable}:{port}"
    key = ""
    if settings.keys():
        # The shell that started the service knows the keys; they are not printed.
        known = "${PLUMBLINE_API_KEYS%%,*}" if settings.api_keys.get_secret_value() else "KEY"
        key = f' -H "Authorization: Bearer {known}"'
    console = answers()
    console.print(f"Plumbline listens on {address} (API: {address}/docs). Try:", markup=False, soft_wrap=True)
    console.print(
        f"  curl -s {address}/v1/trends{key} -H 'Content-Type: application/json' -d '{_EXAMPLE}'",
        markup=False,
        soft_wrap=True,
    )
