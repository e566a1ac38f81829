"""What only a real server shows: chunks, connections, signals."""

from __future__ import annotations

import json
import os
import re
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import httpx2
import pytest

import estimators
from service.errors import ProblemType
from tests.service.series import body
from tests.service.server import Server, serve


class SlowFits:
    """Fits that end only when told to."""

    def __init__(self) -> None:
        self.started = threading.Semaphore(0)
        self.go_on = threading.Event()
        self.count = 0

    def __call__(self, *args: Any, **arguments: Any) -> Any:
        self.count += 1
        self.started.release()
        assert self.go_on.wait(30)
        return estimators.fit_trend(*args, **arguments)


@pytest.fixture
def slow_fits(monkeypatch: pytest.MonkeyPatch) -> Iterator[SlowFits]:
    fits = SlowFits()
    monkeypatch.setattr("service.api.trends.fit_trend", fits)
    yield fits
    fits.go_on.set()


@pytest.fixture(scope="module")
def server() -> Iterator[Server]:
    with serve(max_body_bytes=50_000, body_seconds=0.5) as running:
        yield running


def wait_until(condition: Callable[[], bool]) -> None:
    give_up = time.monotonic() + 30
    while not condition():
        assert time.monotonic() < give_up
        time.sleep(0.005)


def head(length: int) -> bytes:
    """Start of a request that announces a body."""
    return (
        b"POST /v1/trends HTTP/1.1\r\nHost: x\r\nContent-Type: application/json\r\n"
        b"Content-Length: %d\r\n\r\n" % length
    )


def read_response(connection: socket.socket) -> tuple[int, dict[str, Any]]:
    """Status and JSON of an answer after which the server closes."""
    received = b""
    while chunk := connection.recv(65536):
        received += chunk
    head, _, content = received.partition(b"\r\n\r\n")
    return int(head.split()[1]), json.loads(content)


def test_a_new_server_gets_ready_and_answers(server: Server) -> None:
    with httpx2.Client(base_url=server.url) as client:
        wait_until(lambda: client.get("/readyz").status_code == 200)
        response = client.post("/v1/trends", json=body())
    assert response.status_code == 200
    assert [part.partition(";")[0] for part in response.headers["server-timing"].split(", ")] == [
        "parse",
        "queue",
        "fit",
        "encode",
    ]


def test_a_chunked_body_over_the_limit_is_answered_while_the_caller_still_sends(server: Server) -> None:
    def chunks() -> Iterator[bytes]:
        for _ in range(80):
            yield b" " * 1_000

    with httpx2.Client(base_url=server.url) as client:
        response = client.post("/v1/trends", content=chunks(), headers={"content-type": "application/json"})
    assert response.status_code == 413
    assert response.json()["type"] == ProblemType.body_too_large.uri
    assert response.json()["limit"] == 50_000


def test_a_body_that_says_it_is_too_large_is_answered_before_it_is_read(server: Server) -> None:
    with server.connect() as connection:
        connection.sendall(head(60_000) + b" " * 60_000)
        status, problem = read_response(connection)
    assert (status, problem["type"]) == (413, ProblemType.body_too_large.uri)


def test_an_early_answer_reaches_a_caller_who_still_sends(server: Server) -> None:
    with httpx2.Client(base_url=server.url) as client:
        response = client.post("/v1/trends", content=b" " * 49_000, headers={"content-type": "text/plain"})
    assert response.status_code == 415


def test_a_body_that_does_not_arrive_is_not_waited_for(server: Server) -> None:
    with server.connect() as connection:
        connection.sendall(head(100) + b'{"time":')
        status, problem = read_response(connection)
    assert (status, problem["type"]) == (408, ProblemType.request_timeout.uri)


def test_bodies_in_memory_are_bounded_together() -> None:
    with serve(max_body_bytes=40_000, max_buffered_bytes=50_000) as server, server.connect() as first:
        first.sendall(head(39_000) + b" " * 38_000)
        gauge = re.compile(r"^plumbline_body_bytes_buffered (\S+)$", re.MULTILINE)
        with httpx2.Client(base_url=server.url) as client:

            def buffered() -> float:
                found = gauge.search(client.get("/metrics").text)
                assert found is not None
                return float(found[1])

            wait_until(lambda: buffered() == 38_000)
            response = client.post(
                "/v1/trends", content=b" " * 39_000, headers={"content-type": "application/json"}
            )
            assert response.status_code == 503
            assert response.headers["retry-after"] == "1"
            first.close()
            wait_until(lambda: buffered() == 0)


def test_a_full_queue_is_answered_by_503_and_those_before_are_served(slow_fits: SlowFits) -> None:
    with (
        serve(workers=1, queue_length=1, queue_seconds=30) as server,
        httpx2.Client(base_url=server.url, timeout=30) as client,
        ThreadPoolExecutor(2) as callers,
    ):
        running = callers.submit(client.post, "/v1/trends", json=body())
        assert slow_fits.started.acquire(timeout=30)
        waiting = callers.submit(client.post, "/v1/trends", json=body())
        wait_until(lambda: "plumbline_queue_depth 1.0" in client.get("/metrics").text)
        refused = client.post("/v1/trends", json=body())
        slow_fits.go_on.set()
        assert refused.status_code == 503
        assert refused.json()["type"] == ProblemType.busy.uri
        assert int(refused.headers["retry-after"]) == 30
        assert [call.result().status_code for call in (running, waiting)] == [200, 200]


def test_a_fit_past_the_deadline_is_answered_by_504_and_the_server_stays_alive(slow_fits: SlowFits) -> None:
    with (
        serve(workers=1, deadline_seconds=0.2) as server,
        httpx2.Client(base_url=server.url, timeout=30) as client,
    ):
        response = client.post("/v1/trends", json=body())
        assert response.status_code == 504
        assert response.json()["type"] == ProblemType.deadline_exceeded.uri
        assert client.get("/healthz").status_code == 200
        slow_fits.go_on.set()
        wait_until(lambda: client.post("/v1/trends", json=body()).status_code == 200)


def test_a_caller_who_hangs_up_while_waiting_is_taken_from_the_queue(slow_fits: SlowFits) -> None:
    content = json.dumps(body()).encode()
    with (
        serve(workers=1, queue_seconds=30) as server,
        httpx2.Client(base_url=server.url, timeout=30) as client,
        ThreadPoolExecutor(1) as callers,
    ):
        running = callers.submit(client.post, "/v1/trends", json=body())
        assert slow_fits.started.acquire(timeout=30)
        with server.connect() as connection:
            connection.sendall(head(len(content)) + content)
            wait_until(lambda: "plumbline_queue_depth 1.0" in client.get("/metrics").text)
        wait_until(lambda: "plumbline_queue_depth 0.0" in client.get("/metrics").text)
        slow_fits.go_on.set()
        assert running.result().status_code == 200
        assert slow_fits.count == 1


RUN = """
import uvicorn
from service.main import server_config
from service.settings import load_settings

uvicorn.Server(server_config(load_settings())).run()
"""


def start(**environment: str) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, "-c", RUN],
        env=os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)} | environment,
        stderr=subprocess.PIPE,
        text=True,
    )


def test_a_public_address_without_a_key_is_refused_at_the_start() -> None:
    process = start(PLUMBLINE_HOST="0.0.0.0", PLUMBLINE_PORT="0")
    _, said = process.communicate(timeout=60)
    assert process.returncode != 0
    assert "an API key is required" in said
    assert "PLUMBLINE_API_KEYS" in said


def test_a_server_that_is_told_to_stop_ends_in_peace() -> None:
    process = start(PLUMBLINE_PORT="0")
    assert process.stderr is not None
    said = ""
    while "Uvicorn running" not in said:
        line = process.stderr.readline()
        assert line, said
        said += line
    port = re.search(r"127\.0\.0\.1:(\d+)", said)
    assert port is not None
    assert httpx2.get(f"http://127.0.0.1:{port[1]}/healthz").status_code == 200
    process.send_signal(signal.SIGTERM)
    _, rest = process.communicate(timeout=60)
    assert process.returncode in (0, -signal.SIGTERM)
    assert "Traceback" not in said + rest
    assert all(json.loads(line) for line in (said + rest).splitlines())


def test_a_request_that_runs_is_finished_before_the_server_stops(slow_fits: SlowFits) -> None:
    with ThreadPoolExecutor(1) as callers:
        with serve() as server:
            running = callers.submit(httpx2.post, f"{server.url}/v1/trends", json=body(), timeout=30)
            assert slow_fits.started.acquire(timeout=30)
            threading.Timer(0.2, slow_fits.go_on.set).start()
        assert running.result().status_code == 200
