"""Runs the examples of a page as its reader would: in a directory of their own, against a real server.

Addresses ``127.0.0.1:80xx`` in an example are moved to free ports and moved back in its output. A service
is started for port 8000 when the first example needs it. ``make`` commands, which would build an
environment inside the tests, are checked with ``make -n`` (CI runs the real ones), and what ``make serve``
prints is compared with what its last step, ``plumbline serve``, does.
"""

from __future__ import annotations

import contextlib
import io
import os
import re
import shutil
import signal
import socket
import subprocess
import sys
import time
import urllib.error
import urllib.request
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tests.docs.blocks import ROOT, Block, Command, Example, parse_console
from tests.docs.comparison import difference, tidy

SERVICE_PORT = 8000
# Long enough to compile every kernel, which is what happens first after an edit of one.
START_SECONDS = 300
BLOCK_SECONDS = 300

_PORT = re.compile(r"(?<=127\.0\.0\.1:)80\d\d\b|(?<=--port )80\d\d\b|(?<=PLUMBLINE_PORT=)80\d\d\b")
_END = re.compile(r"<end of command (?P<status>\d+)>\n")


@dataclass(frozen=True, slots=True)
class Outcome:
    """What running an example showed.

    ``failures`` are examples that do not work, ``differences`` outputs that are not what the page shows.
    ``lines`` are what should stand between the lines ``first`` and ``last`` of the page, which is how a
    page is refreshed; None where nothing is shown.
    """

    failures: tuple[str, ...] = ()
    differences: tuple[str, ...] = ()
    first: int = 0
    last: int = 0
    lines: tuple[str, ...] | None = None


class Session:
    """Where the examples of one page run; names of earlier ``python`` blocks stay known."""

    def __init__(self, directory: Path) -> None:
        self.directory = directory
        (directory / "examples").symlink_to(ROOT / "examples")
        self._names: dict[str, Any] = {"__name__": "__main__"}
        self._ports: dict[int, int] = {}
        self._server: subprocess.Popen[bytes] | None = None

    def run(self, page: Path, example: Example) -> Outcome:
        """Run one example and compare what it prints with what the page shows."""
        where = f"{page.name}:{example.code.first + 1}"
        if example.code.language == "python":
            return self._run_python(page, where, example)
        if example.code.language == "console":
            return self._run_console(where, example.code)
        return self._run_bash(where, example)

    def close(self) -> None:
        """Stop the service, if one was started."""
        if self._server is not None:
            self._server.terminate()
            self._server.wait(timeout=30)

    def _run_python(self, page: Path, where: str, example: Example) -> Outcome:
        source = "\n" * example.code.first + self._move_ports(example.code.text)
        printed = io.StringIO()
        with contextlib.chdir(self.directory), contextlib.redirect_stdout(printed):
            exec(compile(source, str(page), "exec"), self._names)
        actual = self._restore_ports(tidy(printed.getvalue()))
        if example.output is None:
            return Outcome((f"{where} prints what the page does not show: {actual!r}",) if actual else ())
        return _compare(where, example.output, actual)

    def _run_bash(self, where: str, example: Example) -> Outcome:
        if _is_make(example.code.lines):
            return _dry_run(where, example.code.lines)
        ((actual, status),) = self._shell([example.code.text])
        if status:
            return Outcome((f"{where} ended with status {status}: {actual}",))
        return Outcome() if example.output is None else _compare(where, example.output, actual)

    def _run_console(self, where: str, block: Block) -> Outcome:
        commands = parse_console(block)
        if [command.text for command in commands] == ["make serve"]:
            return self._compare_announcement(where, block, commands[0])
        failures: list[str] = []
        differences: list[str] = []
        lines: list[str] = []
        results = self._shell([command.text for command in commands])
        followers = [*commands[1:], None]
        for command, follower, (actual, status) in zip(commands, followers, results, strict=True):
            # A page that shows an error says so by asking for its status.
            failure_is_shown = follower is not None and follower.text == "echo $?"
            if status and not failure_is_shown:
                failures.append(f"{where}: `{command.text}` ended with status {status}: {actual}")
            elif found := difference(command.expected, actual):
                differences.append(f"{where}: `{command.text}`: {found}")
            shown = actual.split("\n") if actual else []
            lines.extend([*f"$ {command.text}".split("\n"), *shown])
        return Outcome(tuple(failures), tuple(differences), block.first, block.last, tuple(lines))

    def announcement(self) -> str:
        """What the service printed when it was ready, with the port it really has."""
        self._move_ports(f"127.0.0.1:{SERVICE_PORT}")
        return tidy((self.directory / "announced.txt").read_text())

    def _compare_announcement(self, where: str, block: Block, command: Command) -> Outcome:
        actual = self._restore_ports(self.announcement())
        found = difference(command.expected, actual)
        differences = (f"{where}: {found}",) if found else ()
        lines = (f"$ {command.text}", *actual.split("\n"))
        failures = _dry_run(where, [command.text]).failures
        return Outcome(failures, differences, block.first, block.last, lines)

    def _shell(self, commands: list[str]) -> list[tuple[str, int]]:
        """Output and exit status of each command, all run by one bash, so that `cd` and `&` work."""
        # The status is kept for a command that asks for it with `$?`.
        ending = 'status=$?; echo "<end of command $status>"; (exit $status)'
        script = "".join(f"{self._move_ports(command)}\n{ending}\n" for command in commands)
        log = self.directory / "output.txt"
        with log.open("wb") as stream:
            # A file, not a pipe: a program left in the background would hold a pipe open.
            shell = subprocess.Popen(
                ["bash", "-c", script],
                cwd=self.directory,
                env=_environment(),
                stdin=subprocess.DEVNULL,
                stdout=stream,
                stderr=subprocess.STDOUT,
                start_new_session=True,
            )
            try:
                shell.wait(timeout=BLOCK_SECONDS)
            finally:
                with contextlib.suppress(ProcessLookupError):
                    os.killpg(shell.pid, signal.SIGTERM)
                shell.wait()
        printed = self._restore_ports(log.read_text())
        log.unlink()
        pieces = _END.split(printed)
        if len(pieces) != 2 * len(commands) + 1:
            raise RuntimeError(f"the shell stopped early: {printed}")
        return [
            (tidy(output), int(status)) for output, status in zip(pieces[0::2], pieces[1::2], strict=False)
        ]

    def _move_ports(self, text: str) -> str:
        def moved(match: re.Match[str]) -> str:
            port = int(match.group())
            if port not in self._ports:
                self._ports[port] = _free_port()
                if port == SERVICE_PORT:
                    self._start_server(self._ports[port])
            return str(self._ports[port])

        return _PORT.sub(moved, text)

    def _restore_ports(self, text: str) -> str:
        for written, used in self._ports.items():
            text = re.sub(rf"\b{used}\b", str(written), text)
        return text

    def _start_server(self, port: int) -> None:
        log = self.directory / "service.log"
        with (self.directory / "announced.txt").open("wb") as announced, log.open("wb") as stream:
            self._server = subprocess.Popen(
                [program("plumbline"), "serve", "--port", str(port)],
                env=_environment(),
                stdin=subprocess.DEVNULL,
                stdout=announced,
                stderr=stream,
            )
        deadline = time.monotonic() + START_SECONDS
        while not _is_ready(port):
            if self._server.poll() is not None or time.monotonic() > deadline:
                raise RuntimeError(f"the service did not start: {log.read_text()}")
            time.sleep(0.05)


@contextlib.contextmanager
def open_session(directory: Path) -> Iterator[Session]:
    """Session in an empty directory; closes it at the end."""
    session = Session(directory)
    try:
        yield session
    finally:
        session.close()


def program(name: str) -> str:
    """Path of a program, that of this environment first.

    Raises
    ------
    FileNotFoundError
        If there is none.
    """
    found = shutil.which(name, path=_environment()["PATH"])
    if found is None:
        raise FileNotFoundError(name)
    return found


def _compare(where: str, output: Block, actual: str) -> Outcome:
    found = difference(output.text, actual)
    differences = (f"{where}: {found}",) if found else ()
    return Outcome((), differences, output.first, output.last, tuple(actual.split("\n")))


def _is_make(commands: Iterable[str]) -> bool:
    return all(command.startswith("make ") for command in commands)


def _dry_run(where: str, commands: Iterable[str]) -> Outcome:
    failures = []
    for command in commands:
        arguments = [program("make"), "-n", *command.split("#")[0].split()[1:]]
        done = subprocess.run(arguments, cwd=ROOT, capture_output=True, text=True, check=False)
        if done.returncode:
            failures.append(f"{where}: `{command}`: {done.stderr}")
    return Outcome(tuple(failures))


def _environment() -> dict[str, str]:
    """The reader's environment: this Python's programs first, a terminal of 100 columns, no colours."""
    kept = {name: value for name, value in os.environ.items() if not name.startswith("PLUMBLINE_")}
    here = str(Path(sys.executable).parent)
    return kept | {
        "PATH": f"{here}{os.pathsep}{kept.get('PATH', os.defpath)}",
        "COLUMNS": "100",
        "LC_ALL": "C.UTF-8",
        "NO_COLOR": "1",
        "TERM": "dumb",
    }


def _free_port() -> int:
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        return int(listener.getsockname()[1])


def _is_ready(port: int) -> bool:
    try:
        with urllib.request.urlopen(f"http://127.0.0.1:{port}/readyz", timeout=5) as answer:
            return bool(answer.status == 200)
    except (urllib.error.URLError, ConnectionError, TimeoutError):
        return False
