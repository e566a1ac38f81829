"""The start of the service: ready with what the usual fit needs, the rest behind it."""

from __future__ import annotations

import json
import subprocess
import sys
import threading
from collections.abc import Iterator

import numba
import pytest
from numba.core.event import Event, Listener, install_listener

from estimators import kernels
from service import warmth
from tests.project.tree import ROOT
from tests.service.conftest import MakeClient
from tests.service.series import body


def until_ready(client: object, seconds: float = 60.0) -> dict[str, object]:
    event = threading.Event()
    for _ in range(int(seconds / 0.01)):
        response = client.get("/readyz")  # type: ignore[attr-defined]
        if response.status_code == 200:
            answer: dict[str, object] = response.json()
            return answer
        event.wait(0.01)
    raise AssertionError("not ready")


@pytest.fixture
def held(monkeypatch: pytest.MonkeyPatch) -> Iterator[threading.Event]:
    """Kernels of which all but the first load once the event is set."""
    go_on = threading.Event()

    def slow_warm() -> Iterator[tuple[int, int, str]]:
        yield 1, 3, "first"
        go_on.wait(30)
        yield 2, 3, "second"
        yield 3, 3, "third"

    monkeypatch.setattr(kernels, "warm", slow_warm)
    yield go_on
    go_on.set()


def test_the_service_is_ready_while_other_kernels_come_from_the_cache(
    make_client: MakeClient, held: threading.Event
) -> None:
    client = make_client()
    assert until_ready(client) == {"status": "ready", "kernels": 3, "loaded": 1}
    assert client.post("/v1/trends", json=body()).status_code == 200
    assert not held.is_set()


def test_the_service_is_not_ready_before_the_end_where_something_had_to_be_compiled(
    make_client: MakeClient,
    held: threading.Event,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    asked = threading.Event()

    def compiled(_tell: object) -> bool:
        asked.set()
        return True

    monkeypatch.setattr(warmth, "load_usual", compiled)
    client = make_client()
    assert asked.wait(30)
    refused = client.get("/readyz")
    assert refused.status_code == 503
    assert refused.json()["detail"].startswith("1 of 3 compiled functions")
    # It is what an orchestrator asks for, and no error to be logged.
    assert capsys.readouterr().err == ""
    held.set()
    assert until_ready(client) == {"status": "ready", "kernels": 3, "loaded": 3}


def test_what_positions_need_is_loaded_behind_readiness_and_before_the_other_kernels(
    make_client: MakeClient, held: threading.Event, monkeypatch: pytest.MonkeyPatch
) -> None:
    loaded = threading.Event()
    monkeypatch.setattr(warmth, "load_positions", loaded.set)
    until_ready(make_client())
    assert loaded.wait(30)
    assert not held.is_set()


def test_positions_need_no_code_that_warming_does_not_load() -> None:
    # Compiled functions are declared as kernels, so that `plumbline warm` finds all of them.
    for _ in kernels.warm():
        pass
    seen: list[Event] = []

    class Seen(Listener):
        def on_start(self, event: Event) -> None:
            seen.append(event)

        def on_end(self, event: Event) -> None: ...

    with install_listener("numba:compile", Seen()):
        warmth.load_positions()
    assert seen == []


def test_what_is_loaded_is_not_compiled_again() -> None:
    told: list[str] = []
    warmth.load_usual(lambda: told.append("first"))
    assert warmth.load_usual(lambda: told.append("again")) is False
    assert "again" not in told


def test_a_compilation_is_noticed_and_told_once(monkeypatch: pytest.MonkeyPatch) -> None:
    def fit_that_compiles(*_series: object) -> None:
        numba.njit(lambda x: x + 1)(1)

    monkeypatch.setattr(warmth, "fit_trend", fit_that_compiles)
    told: list[str] = []
    assert warmth.load_usual(lambda: told.append("compiling")) is True
    assert told == ["compiling"]


def test_a_start_imports_nothing_that_only_batches_and_pictures_need() -> None:
    script = (
        "import sys\n"
        "from service.cli.postponing import postpone_imports\n"
        "postpone_imports()\n"
        "import service.cli.serving\n"
        "from service.main import server_config\n"
        "from service.settings import Settings\n"
        "from service.warmth import load_usual\n"
        "server_config(Settings()).load()\n"
        "load_usual(lambda: None)\n"
        "unused = {'pandas', 'pyarrow', 'matplotlib', 'scipy.optimize', 'numpy.f2py.f2py2e'}\n"
        "heavy = unused & set(sys.modules)\n"
        "sys.exit(repr(heavy) if heavy else 0)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", script], cwd=ROOT, capture_output=True, text=True, check=False, timeout=600
    )
    assert done.returncode == 0, done.stderr


def test_the_log_of_a_start_is_json_in_every_line() -> None:
    with subprocess.Popen(
        [sys.executable, "-m", "service.cli", "serve", "--port", "0"],
        cwd=ROOT,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as process:
        assert process.stdout is not None
        assert process.stdout.readline().startswith("Plumbline listens on ")
        process.terminate()
        _, said = process.communicate(timeout=60)
    events = [json.loads(line)["event"] for line in said.splitlines()]
    assert "Application startup complete." in events
