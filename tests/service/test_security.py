from __future__ import annotations

import pytest
from fastapi.testclient import TestClient

from service.errors import ProblemType
from tests.service.conftest import MakeClient
from tests.service.series import body

KEY = "the-first-key-of-two"
OTHER = "the-second-key-of-two"


@pytest.fixture
def guarded(make_client: MakeClient) -> TestClient:
    return make_client(api_keys=f"{KEY},{OTHER}")


@pytest.mark.parametrize(
    "headers",
    [{"authorization": f"Bearer {KEY}"}, {"authorization": f"bearer {OTHER}"}, {"x-api-key": OTHER}],
)
def test_any_key_in_force_opens(guarded: TestClient, headers: dict[str, str]) -> None:
    assert guarded.post("/v1/trends", json=body(), headers=headers).status_code == 200


@pytest.mark.parametrize(
    "headers",
    [
        {},
        {"authorization": "Bearer"},
        {"authorization": "Bearer wrong"},
        {"authorization": f"Basic {KEY}"},
        {"authorization": f"Bearer {KEY} "[:-2]},
        {"authorization": f"Bearer {KEY},{OTHER}"},
        {"x-api-key": ""},
        {"x-api-key": KEY.upper()},
    ],
)
@pytest.mark.parametrize(
    ("method", "path"), [("POST", "/v1/trends"), ("GET", "/v1/methods"), ("GET", "/metrics"), ("GET", "/x")]
)
def test_without_a_key_everything_else_is_closed(
    guarded: TestClient, headers: dict[str, str], method: str, path: str
) -> None:
    response = guarded.request(method, path, headers=headers)
    assert response.status_code == 401
    assert response.json()["type"] == ProblemType.authentication_required.uri
    assert response.headers["www-authenticate"].startswith("Bearer")
    assert KEY not in response.text


@pytest.mark.parametrize("path", ["/healthz", "/docs", "/docs/style.css", "/openapi.json"])
def test_probes_and_documentation_are_open(guarded: TestClient, path: str) -> None:
    assert guarded.get(path).status_code == 200


def test_the_size_of_a_body_is_checked_before_the_key(make_client: MakeClient) -> None:
    client = make_client(api_keys=KEY, max_body_bytes=1024)
    assert client.post("/v1/trends", content=b" " * 2000).status_code == 413


@pytest.mark.parametrize("path", ["/healthz", "/v1/methods", "/nowhere", "/docs"])
def test_answers_tell_browsers_to_do_nothing_with_them(client: TestClient, path: str) -> None:
    headers = client.get(path).headers
    assert headers["x-content-type-options"] == "nosniff"
    assert headers["content-security-policy"].startswith("default-src 'none'")
    assert "frame-ancestors 'none'" in headers["content-security-policy"]
    assert headers["referrer-policy"] == "no-referrer"


def test_answers_are_not_kept_by_caches(client: TestClient) -> None:
    assert client.post("/v1/trends", json=body()).headers["cache-control"] == "no-store"


def test_other_origins_are_told_nothing_by_default(client: TestClient) -> None:
    response = client.get("/healthz", headers={"origin": "https://example.org"})
    assert "access-control-allow-origin" not in response.headers


def test_origins_that_are_allowed_may_ask_even_before_they_send_a_key(make_client: MakeClient) -> None:
    client = make_client(cors_origins="https://example.org", api_keys=KEY)
    response = client.options(
        "/v1/trends", headers={"origin": "https://example.org", "access-control-request-method": "POST"}
    )
    assert response.status_code == 200
    assert response.headers["access-control-allow-origin"] == "https://example.org"
