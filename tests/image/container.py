"""Runs a mounted image as a strict orchestrator would: read-only root, another user, no capabilities.

Everything is done with util-linux, so nothing but ``buildah`` is needed and a test sees the plain process.
The network is the host's; a service in a container gets a free port.
"""

from __future__ import annotations

import contextlib
import json
import os
import shutil
import signal
import socket
import subprocess
import time
import urllib.error
import urllib.request
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

START_SECONDS = 60
#: No user of the image and none of the host.
UID = 23_456
KEY = "a-key-that-only-this-test-knows"

# $1 root, $2 user, $3 working directory, then the command.
_ENTER = """
set -e
root=$1 user=$2 directory=$3
shift 3
mount --bind "$root" "$root"
mount -o remount,bind,ro "$root"
mount -t proc proc "$root/proc"
mount -t tmpfs -o mode=1777,size=64m tmpfs "$root/tmp"
exec chroot "$root" setpriv --reuid="$user" --regid="$user" --clear-groups --bounding-set=-all \
  --inh-caps=-all --no-new-privs env --chdir="$directory" "$@"
"""


@dataclass(frozen=True)
class Image:
    """An image that is mounted.

    Attributes
    ----------
    root : Path
        Its root directory.
    config : mapping
        Its configuration as docker writes it: ``Env``, ``Entrypoint``, ``Cmd``, ``Healthcheck`` and so on.
    """

    root: Path
    config: Mapping[str, Any]

    def start(
        self, *arguments: str, entrypoint: Sequence[str] | None = None, **environment: str
    ) -> subprocess.Popen[str]:
        """Start a container; arguments take the place of the image's, as they do for ``docker run``."""
        command = [
            *(self.config["Entrypoint"] if entrypoint is None else entrypoint),
            *(arguments or (self.config["Cmd"] if entrypoint is None else ())),
        ]
        own = dict(entry.split("=", 1) for entry in self.config["Env"])
        directory = self.config["WorkingDir"] or "/"
        return subprocess.Popen(
            [
                *(str(shutil.which("unshare")), "--mount", "--pid", "--fork", "--kill-child"),
                *("sh", "-c", _ENTER, "container", str(self.root), str(UID), directory, *command),
            ],
            env=own | environment,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )

    def run(
        self, *arguments: str, entrypoint: Sequence[str] | None = None, given: str = "", **environment: str
    ) -> subprocess.CompletedProcess[str]:
        """Run a container to its end, with something on its standard input."""
        with self.start(*arguments, entrypoint=entrypoint, **environment) as process:
            printed, said = process.communicate(given, timeout=START_SECONDS)
        return subprocess.CompletedProcess(process.args, process.returncode, printed, said)

    @contextmanager
    def serve(self, **environment: str) -> Iterator[Service]:
        """Run the service as the image does by itself, for as long as the block lasts."""
        with socket.socket() as listener:
            listener.bind(("127.0.0.1", 0))
            port = listener.getsockname()[1]
        with self.start(PLUMBLINE_PORT=str(port), **environment) as process:
            service = Service(port, process)
            try:
                service.wait_until_ready()
                yield service
            finally:
                service.stop()


@dataclass(frozen=True)
class Service:
    """A service in a container, and the process on the host that started it."""

    port: int
    process: subprocess.Popen[str]

    @property
    def url(self) -> str:
        return f"http://127.0.0.1:{self.port}"

    @property
    def pid(self) -> int:
        """Process of the service, which is number 1 in its container."""
        started = self.process.pid
        return int(Path(f"/proc/{started}/task/{started}/children").read_text())

    def stop(self) -> None:
        """End the service at once.

        It is not enough to end the process that started it: the kernel forgets to end a child with its parent
        when the child becomes another user.
        """
        with contextlib.suppress(ProcessLookupError, FileNotFoundError, ValueError):
            os.kill(self.pid, signal.SIGKILL)
        self.process.kill()

    def wait_until_ready(self) -> None:
        give_up = time.monotonic() + START_SECONDS
        while self.process.poll() is None and time.monotonic() < give_up:
            try:
                with urllib.request.urlopen(f"{self.url}/readyz", timeout=5) as answer:
                    answer.read()
                    return
            except (urllib.error.URLError, ConnectionError, TimeoutError):
                time.sleep(0.01)
        self.stop()
        raise RuntimeError(f"the service did not start: {self.process.communicate()[1]}")


def read_config(inspected: str) -> dict[str, Any]:
    """Configuration in what ``buildah inspect --type image`` prints."""
    config = json.loads(inspected)["Docker"]["config"]
    if not isinstance(config, dict):
        raise TypeError("an image without a configuration")
    return config
