from __future__ import annotations

import re
import threading
import time
from collections.abc import Iterator
from html.parser import HTMLParser

import pytest
from fastapi.testclient import TestClient

import estimators
from estimators import kernels
from service.api import docs
from service.errors import ProblemType
from service.warmth import Warmth
from tests.service.conftest import MakeClient
from tests.service.series import body


def test_the_process_is_alive(client: TestClient) -> None:
    assert client.get("/healthz").json() == {"status": "ok"}


def test_the_service_is_ready_once_warm(client: TestClient) -> None:
    give_up = time.monotonic() + 120
    while (response := client.get("/readyz")).status_code == 503 and time.monotonic() < give_up:
        assert response.json()["type"] == ProblemType.not_ready.uri
        assert response.headers["retry-after"] == "1"
    assert response.status_code == 200
    assert response.json()["status"] == "ready"


def test_the_service_is_not_ready_before(make_client: MakeClient, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Warmth, "start", lambda _: None)
    response = make_client().get("/readyz")
    assert response.status_code == 503
    assert response.json()["type"] == ProblemType.not_ready.uri


def test_a_fit_that_comes_too_early_is_told_to_come_back(
    make_client: MakeClient, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Warmth, "start", lambda _: None)
    response = make_client(queue_seconds=0.01).post("/v1/trends", json=body())
    assert response.status_code == 503
    assert response.json()["type"] == ProblemType.not_ready.uri
    assert response.headers["retry-after"] == "1"


def test_a_fit_that_comes_a_moment_too_early_waits(
    make_client: MakeClient, monkeypatch: pytest.MonkeyPatch
) -> None:
    go_on = threading.Event()

    def slow_warm() -> Iterator[tuple[int, int, str]]:
        go_on.wait(30)
        yield 1, 1, "slow"

    monkeypatch.setattr(kernels, "warm", slow_warm)
    client = make_client(queue_seconds=30)
    assert client.get("/readyz").status_code == 503
    threading.Timer(0.1, go_on.set).start()
    assert client.post("/v1/trends", json=body()).status_code == 200


@pytest.mark.filterwarnings("ignore::pytest.PytestUnhandledThreadExceptionWarning")
def test_a_service_that_could_not_warm_says_so(
    make_client: MakeClient, monkeypatch: pytest.MonkeyPatch
) -> None:
    def broken_warm() -> Iterator[tuple[int, int, str]]:
        raise OSError("no compiler")

    monkeypatch.setattr(kernels, "warm", broken_warm)
    client = make_client()
    give_up = time.monotonic() + 30
    while "could not" not in client.get("/readyz").json()["detail"]:
        assert time.monotonic() < give_up
    assert client.post("/v1/trends", json=body()).status_code == 503


@pytest.mark.parametrize("kind", ["methods", "models"])
def test_the_catalogue_lists_the_registry(client: TestClient, kind: str) -> None:
    listed = client.get(f"/v1/{kind}").json()[kind]
    assert [row["name"] for row in listed] == list(getattr(estimators, kind)())
    assert all(row["title"] and row["summary"] for row in listed)


def test_the_front_door_leads_to_the_documentation(client: TestClient) -> None:
    response = client.get("/")
    assert response.status_code == 200
    assert response.url.path == "/docs"


@pytest.mark.parametrize("kind", list(ProblemType))
def test_the_type_of_every_problem_leads_to_its_explanation(client: TestClient, kind: ProblemType) -> None:
    response = client.get(kind.uri)
    assert response.status_code == 200
    assert f'id="{kind.slug}"' in response.text


class Links(HTMLParser):
    """What a page loads and links to, and the anchors it has."""

    def __init__(self) -> None:
        super().__init__()
        self.targets: list[str] = []
        self.anchors: set[str] = set()
        self.tags: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        found = dict(attrs)
        self.anchors.add(found.get("id") or "")
        self.targets += [found[name] or "" for name in ("href", "src") if name in found]


def test_the_documentation_loads_nothing_from_elsewhere_and_links_to_nothing_missing(
    client: TestClient,
) -> None:
    page = client.get("/docs")
    links = Links()
    links.feed(page.text)
    assert "script" not in links.tags
    assert "style" not in links.tags
    for target in links.targets:
        if target.startswith("#"):
            assert target[1:] in links.anchors
        else:
            assert client.get(target).status_code == 200, target


def test_the_documentation_shows_every_operation_parameter_and_problem(client: TestClient) -> None:
    page = client.get("/docs").text
    document = client.get("/openapi.json").json()
    for path, operations in document["paths"].items():
        assert f"<code>{path}</code>" in page
        for operation in operations.values():
            for parameter in operation.get("parameters", []):
                assert f"<code>{parameter['name']}</code>" in page
    for kind in ProblemType:
        assert kind.uri in page


def test_the_curl_line_of_the_documentation_is_a_request_that_works(client: TestClient) -> None:
    found = re.search(r"-d '(?P<body>.*)'$", docs.CURL)
    assert found is not None
    response = client.post("/v1/trends", content=found["body"], headers={"content-type": "application/json"})
    assert response.status_code == 200
