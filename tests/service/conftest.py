from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import ExitStack

import pytest
from fastapi import FastAPI
from fastapi.testclient import TestClient

from estimators import kernels
from service.main import create_app
from service.settings import Settings

MakeClient = Callable[..., TestClient]


@pytest.fixture(scope="session", autouse=True)
def warm_kernels() -> None:
    """Compile once, so that no test meets a service that is still starting."""
    for _ in kernels.warm():
        pass


@pytest.fixture
def make_client() -> Iterator[MakeClient]:
    """Clients of apps with settings of their own; their lifespans end with the test."""
    with ExitStack() as stack:

        def make(**settings: object) -> TestClient:
            app = create_app(Settings(**{"log_level": "error", **settings}))  # type: ignore[arg-type]
            return stack.enter_context(TestClient(app))

        yield make


@pytest.fixture(scope="module")
def app() -> FastAPI:
    return create_app(Settings(log_level="error", max_body_bytes=200_000, max_points=5_000))


@pytest.fixture(scope="module")
def client(app: FastAPI) -> Iterator[TestClient]:
    """One client for tests that change nothing; errors of the service itself surface as exceptions."""
    with TestClient(app) as opened:
        yield opened
