from __future__ import annotations

import json
import threading
from typing import Any

import httpx2
import numpy as np
import pyarrow as pa
import pytest
from fastapi.testclient import TestClient

import service.batches
from estimators import fit_trends
from estimators.consensus.cancellation import Cancelled, cancel_flag
from service.errors import ProblemType
from service.schemas.problems import ProblemAnswer
from tests.service.series import CSV
from tests.service.server import serve
from tests.service.tables import ENDPOINT, as_csv, long_table

TABLE = long_table(6)
NDJSON = CSV | {"accept": "application/x-ndjson"}


@pytest.fixture(autouse=True)
def a_slice_per_series(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(service.batches, "SLICE_ROWS", 1)


def test_the_slices_change_no_byte(client: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    for form in ("json", "csv", "ndjson"):
        answers = []
        for rows in (1, 60, 10**6):
            monkeypatch.setattr(service.batches, "SLICE_ROWS", rows)
            query = f"?format={form}&points=true"
            answers.append(client.post(ENDPOINT + query, content=as_csv(TABLE), headers=CSV).content)
        assert answers[0] == answers[1] == answers[2]


@pytest.mark.parametrize("form", ["arrow", "parquet", "ndjson"])
def test_slices_of_different_shapes_have_the_same_columns(client: TestClient, form: str) -> None:
    time = np.arange(30)
    grown = np.exp(0.2 * time) * (1 + 0.02 * np.cos(7 * time))
    value = np.concatenate([grown, 5.0 + 2.0 * time + np.cos(7 * time)])
    table = pa.table({"series": ["grown"] * 30 + ["line"] * 30, "time": np.tile(time, 2), "value": value})
    query = f"?model=auto&format={form}"
    answer = client.post(ENDPOINT + query, content=as_csv(table), headers=CSV)
    assert answer.status_code == 200, answer.text
    if form == "ndjson":
        grown_row, line_row = map(json.loads, answer.text.splitlines())
        assert list(grown_row) == list(line_row)
        assert (grown_row["rate"], grown_row["slope"]) == (pytest.approx(0.2, abs=0.01), None)
        assert (line_row["rate"], line_row["slope"]) == (None, pytest.approx(2.0, abs=0.1))


def test_a_line_leaves_before_the_last_series_is_fitted(monkeypatch: pytest.MonkeyPatch) -> None:
    may_go_on = threading.Event()
    calls = 0

    def halting(*arguments: Any, **options: Any) -> Any:
        nonlocal calls
        calls += 1
        if calls == 3:
            assert may_go_on.wait(60)
        return fit_trends(*arguments, **options)

    monkeypatch.setattr(service.batches, "fit_trends", halting)
    with (
        serve() as server,
        httpx2.stream(
            "POST", server.url + ENDPOINT, content=as_csv(TABLE), headers=NDJSON, timeout=60
        ) as answer,
    ):
        lines = answer.iter_lines()
        first = json.loads(next(lines))
        may_go_on.set()
        rest = [json.loads(line) for line in lines]
    assert len([first, *rest]) == 6


def test_an_answer_that_cannot_be_finished_ends_with_a_problem(
    client: TestClient, monkeypatch: pytest.MonkeyPatch
) -> None:
    calls = 0

    def failing(*arguments: Any, **options: Any) -> Any:
        nonlocal calls
        calls += 1
        if calls == 3:
            raise Cancelled
        return fit_trends(*arguments, **options)

    monkeypatch.setattr(service.batches, "fit_trends", failing)
    response = client.post(ENDPOINT, content=as_csv(TABLE), headers=NDJSON)
    assert response.status_code == 200
    *rows, last = map(json.loads, response.text.splitlines())
    assert [row["fitted"] for row in rows] == [True, True]
    assert ProblemAnswer.model_validate(last).type == ProblemType.deadline_exceeded.uri


def test_a_problem_before_the_first_line_is_answered_with_its_status(client: TestClient) -> None:
    response = client.post(ENDPOINT, content="series,time,value\na,1,x\n", headers=NDJSON)
    assert (response.status_code, response.json()["field"]) == (422, "value")


def test_a_fit_whose_caller_left_is_ended(monkeypatch: pytest.MonkeyPatch) -> None:
    begun, ended = threading.Event(), threading.Event()

    def endless(*arguments: Any, **options: Any) -> Any:
        if is_first.acquire(blocking=False):
            return fit_trends(*arguments, **options)
        begun.set()
        flag = cancel_flag()
        while not flag[0]:
            ended.wait(0.005)
        ended.set()
        raise Cancelled

    is_first = threading.Semaphore(1)
    monkeypatch.setattr(service.batches, "fit_trends", endless)
    with serve(deadline_seconds=600) as server:
        with httpx2.stream(
            "POST", server.url + ENDPOINT, content=as_csv(TABLE), headers=NDJSON, timeout=60
        ) as answer:
            next(answer.iter_lines())
            assert begun.wait(60)
        assert ended.wait(60)


@pytest.mark.parametrize("form", ["json", "ndjson", "parquet"])
def test_the_deadline_holds_for_the_whole_batch(make_client: object, form: str) -> None:
    client: TestClient = make_client(deadline_seconds=1e-6)  # type: ignore[operator]
    response = client.post(f"{ENDPOINT}?format={form}", content=as_csv(TABLE), headers=CSV)
    assert response.status_code == 504
