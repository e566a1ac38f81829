"""``plumbline serve`` and ``plumbline warm``: their options."""

from __future__ import annotations

from typing import Annotated

import typer


def serve(
    host: Annotated[
        str | None, typer.Option(help="Address to listen on. Default: PLUMBLINE_HOST, else 127.0.0.1.")
    ] = None,
    port: Annotated[
        int | None, typer.Option(min=0, max=65535, help="Port. Default: PLUMBLINE_PORT, else 8000.")
    ] = None,
) -> None:
    """Serve fits over HTTP; settings come from PLUMBLINE_* variables."""
    import gc

    # What is imported stays: looking for garbage in it meanwhile takes a fifth of the start.
    gc.disable()
    try:
        from service.cli.postponing import postpone_imports

        postpone_imports()
        from service.cli.serving import run_server

        run_server(host, port)
    finally:
        gc.enable()


def warm() -> None:
    """Compile the kernels now, so that no first request waits for them."""
    from service.cli.warming import warm_kernels

    warm_kernels()
