from __future__ import annotations

import json
from typing import Any

import pytest
from prometheus_client.parser import text_string_to_metric_families

from tests.service.conftest import MakeClient
from tests.service.series import body

KEY = "a-key-that-is-long-enough"


def lines(captured: str) -> list[dict[str, Any]]:
    return [json.loads(line) for line in captured.splitlines()]


def samples(text: str) -> dict[tuple[str, tuple[tuple[str, str], ...]], float]:
    return {
        (sample.name, tuple(sorted(sample.labels.items()))): sample.value
        for family in text_string_to_metric_families(text)
        for sample in family.samples
    }


def test_every_request_has_one_access_line(
    capsys: pytest.CaptureFixture[str], make_client: MakeClient
) -> None:
    client = make_client(log_level="info")
    response = client.post("/v1/trends", json=body())
    client.get("/nowhere")
    found = [line for line in lines(capsys.readouterr().err) if line["event"] == "request"]
    assert [(line["method"], line["path"], line["status"]) for line in found] == [
        ("POST", "/v1/trends", 200),
        ("GET", "/nowhere", 404),
    ]
    assert found[0]["request_id"] == response.headers["x-request-id"]
    assert found[0]["points"] == 40


def test_logs_hold_neither_bodies_nor_queries_nor_keys(
    capsys: pytest.CaptureFixture[str], make_client: MakeClient
) -> None:
    client = make_client(log_level="debug", api_keys=KEY)
    headers = {"authorization": f"Bearer {KEY}"}
    client.post("/v1/trends?title=private-title", json=body(value=[12345.678] * 40), headers=headers)
    client.post(
        "/v1/trends", content=b'{"private-body": 1}', headers=headers | {"content-type": "application/json"}
    )
    logged = capsys.readouterr().err
    assert '"status": 200' in logged
    for secret in (KEY, "private-title", "12345.678", "private-body"):
        assert secret not in logged


def test_console_logs_are_for_people(capsys: pytest.CaptureFixture[str], make_client: MakeClient) -> None:
    make_client(log_level="info", log_format="console").get("/healthz")
    assert "path=/healthz" in capsys.readouterr().err


def test_the_log_level_is_obeyed(capsys: pytest.CaptureFixture[str], make_client: MakeClient) -> None:
    make_client(log_level="error").get("/healthz")
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize("given", ["abc-123", "A.b_c", "x" * 64])
def test_a_sane_request_id_is_kept(make_client: MakeClient, given: str) -> None:
    response = make_client().get("/healthz", headers={"x-request-id": given})
    assert response.headers["x-request-id"] == given


@pytest.mark.parametrize("given", ["", "a b", "x" * 65, "{}", 'a"b', "a\tb"])
def test_any_other_request_id_is_replaced(make_client: MakeClient, given: str) -> None:
    response = make_client().get("/healthz", headers={"x-request-id": given})
    assert response.headers["x-request-id"] not in ("", given)


def test_requests_have_ids_of_their_own(make_client: MakeClient) -> None:
    client = make_client()
    assert len({client.get("/healthz").headers["x-request-id"] for _ in range(10)}) == 10


def test_metrics_count_requests_points_and_phases(make_client: MakeClient) -> None:
    client = make_client()
    for _ in range(3):
        client.post("/v1/trends", json=body())
    client.post("/v1/trends", json={"time": [1]})
    found = samples(client.get("/metrics").text)
    route = ("route", "/v1/trends")
    assert found["plumbline_requests_total", (("method", "POST"), route, ("status", "200"))] == 3
    assert found["plumbline_requests_total", (("method", "POST"), route, ("status", "422"))] == 1
    assert found["plumbline_points_fitted_total", ()] == 120
    for phase in ("parse", "queue", "fit", "encode"):
        assert found["plumbline_phase_seconds_count", (("phase", phase),)] == 3
    assert found["plumbline_queue_depth", ()] == 0
    assert found["plumbline_fits_running", ()] == 0
    assert found["plumbline_body_bytes_buffered", ()] == 0


def test_strangers_cannot_grow_the_labels_of_metrics(make_client: MakeClient) -> None:
    client = make_client()
    for number in range(5):
        client.request(f"ODD{number}", f"/nowhere/{number}")
    found = samples(client.get("/metrics").text)
    labels = [labels for name, labels in found if name == "plumbline_requests_total"]
    assert labels == [(("method", "other"), ("route", "unmatched"), ("status", "404"))]


def test_two_apps_in_a_process_count_apart(make_client: MakeClient) -> None:
    first, second = make_client(), make_client()
    first.get("/healthz")
    labels = (("method", "GET"), ("route", "/healthz"), ("status", "200"))
    assert samples(first.get("/metrics").text)["plumbline_requests_total", labels] == 1
    assert ("plumbline_requests_total", labels) not in samples(second.get("/metrics").text)
