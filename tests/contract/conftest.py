from __future__ import annotations

import pytest

from estimators import kernels


@pytest.fixture(scope="session", autouse=True)
def warm_kernels() -> None:
    """Compile once, so that no test meets a service that is still starting."""
    for _ in kernels.warm():
        pass
