from __future__ import annotations

import json
import os
import re
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.metadata import version

from typer.testing import CliRunner

import estimators
from service.cli import app
from tests.external import require_program
from tests.project.tree import ROOT

COMMAND = [sys.executable, "-m", "service.cli"]


def run(*arguments: str, **environment: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [*COMMAND, *arguments],
        cwd=ROOT,
        env=os.environ | environment,
        capture_output=True,
        text=True,
        check=False,
        timeout=300,
    )


def test_the_version_is_that_of_the_package() -> None:
    done = run("--version")
    assert (done.returncode, done.stdout) == (0, f"plumbline {version('plumbline')}\n")


def test_help_lists_the_commands() -> None:
    shown = CliRunner().invoke(app, ["--help"]).stdout
    for command in ("fit", "serve", "warm", "methods", "models"):
        assert f" {command} " in shown


def test_help_loads_nothing_heavy() -> None:
    script = (
        "import sys\n"
        "from service.cli import app\n"
        "app(['fit', '--help'], standalone_mode=False)\n"
        "heavy = {'numpy', 'numba', 'scipy', 'matplotlib', 'uvicorn', 'fastapi'} & set(sys.modules)\n"
        "sys.exit(repr(heavy) if heavy else 0)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", script], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr


def test_a_fit_without_a_picture_does_not_load_matplotlib() -> None:
    script = (
        "import sys\n"
        "from typer.testing import CliRunner\n"
        "from service.cli import app\n"
        "done = CliRunner().invoke(app, ['fit', '-'], input='1,2\\n2,3\\n3,4.5\\n4,5\\n')\n"
        "assert done.exit_code == 0, done.output\n"
        "sys.exit('matplotlib' in sys.modules)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", script], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr


def test_methods_lists_every_method_of_the_registry() -> None:
    shown = CliRunner().invoke(app, ["methods"], env={"COLUMNS": "200"}).stdout
    for row in estimators.methods().values():
        assert row.name in shown
    not_robust = [row for row in estimators.methods().values() if not row.robust]
    assert shown.count("Not robust") == len(not_robust) > 0


def test_models_lists_every_model_of_the_registry() -> None:
    shown = CliRunner().invoke(app, ["models"], env={"COLUMNS": "200"}).stdout
    for row in estimators.models().values():
        assert row.name in shown
        assert row.equation in shown


def test_warm_tells_its_progress_in_plain_lines_on_standard_error() -> None:
    done = run("warm")
    assert done.returncode == 0
    assert done.stdout == ""
    assert "\x1b" not in done.stderr
    *steps, last = done.stderr.splitlines()
    ready = re.fullmatch(r"(\d+) kernels ready in \d+\.\d s\.", last)
    assert ready is not None
    assert [step.split(":")[0] for step in steps] == [
        f"Loaded {k} of {ready[1]}" for k in range(1, len(steps) + 1)
    ]
    assert len(steps) == int(ready[1])


def test_an_output_that_is_closed_early_is_no_traceback() -> None:
    done = subprocess.run(
        [require_program("bash"), "-c", f"'{sys.executable}' -m service.cli methods | head -n 1"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    assert "Traceback" not in done.stderr


@contextmanager
def served(*arguments: str, **environment: str) -> Iterator[list[str]]:
    """A running service, and the lines it greets with."""
    with subprocess.Popen(
        [*COMMAND, "serve", "--port", "0", *arguments],
        cwd=ROOT,
        env=os.environ | {"PLUMBLINE_LOG_LEVEL": "error"} | environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    ) as process:
        assert process.stdout is not None
        try:
            yield [process.stdout.readline().rstrip("\n") for _ in range(2)]
        finally:
            process.terminate()
            process.wait(timeout=60)


def ask(line: str, **environment: str) -> dict[str, object]:
    bash = require_program("bash")
    require_program("curl")
    done = subprocess.run(
        [bash, "-c", line],
        env=os.environ | environment,
        capture_output=True,
        text=True,
        check=True,
        timeout=60,
    )
    return dict(json.loads(done.stdout))


def test_serve_prints_the_address_and_a_curl_line_that_works_when_pasted() -> None:
    with served() as (greeting, line):
        address = re.search(r"http://127\.0\.0\.1:\d+", greeting)
        assert address is not None
        assert line.strip().startswith(f"curl -s {address[0]}/v1/trends")
        answer = ask(line)
    assert answer["model"] == "line"
    assert answer["consensus"]["inliers"] == 7  # type: ignore[index]


def test_the_curl_line_carries_a_key_where_one_is_needed_and_does_not_print_it() -> None:
    keys = {"PLUMBLINE_API_KEYS": "first-key-of-this-test,second-key-of-this-test"}
    with served("--host", "0.0.0.0", **keys) as (_, line):
        assert "key-of-this-test" not in line
        assert ask(line, **keys)["model"] == "line"


def test_serve_refuses_a_public_address_without_a_key() -> None:
    done = run("serve", "--host", "0.0.0.0", "--port", "0", PLUMBLINE_API_KEYS="")
    assert done.returncode == 2
    assert "API key is required" in done.stderr
    assert "Traceback" not in done.stderr


def test_serve_says_that_a_port_is_in_use() -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        done = run("serve", "--port", str(port))
    assert done.returncode == 2
    assert f"cannot listen on 127.0.0.1 port {port}" in done.stderr
    assert "--port" in done.stderr


def test_serve_stops_when_interrupted() -> None:
    import signal

    with subprocess.Popen(
        [*COMMAND, "serve", "--port", "0"],
        cwd=ROOT,
        env=os.environ | {"PLUMBLINE_LOG_LEVEL": "error"},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as process:
        assert process.stdout is not None
        process.stdout.readline()
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=60)
    assert process.returncode == 0
    assert out.endswith("Stopped.\n")
    assert "Traceback" not in err
