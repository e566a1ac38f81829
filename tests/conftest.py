"""Shared fixtures: where the published data sets are."""

from __future__ import annotations

import os
from pathlib import Path

import pytest


def _published(folder: str, what: str) -> Path:
    """Folder of the published data; ``PLUMBLINE_TEST_DATA`` names the one that holds it."""
    beside = Path(__file__).resolve().parents[2] / "shared" / "data"
    found = Path(os.environ.get("PLUMBLINE_TEST_DATA", beside)) / folder
    if not found.is_dir():
        pytest.skip(f"the {what} are not here; PLUMBLINE_TEST_DATA says where they are")
    return found


@pytest.fixture(scope="session")
def trend_data() -> Path:
    return _published("trends", "published data sets")


@pytest.fixture(scope="session")
def gnss_data() -> Path:
    return _published("gnss", "recorded pseudoranges")


@pytest.fixture(scope="session")
def track_data() -> Path:
    return _published("trajectories", "published tracks")


@pytest.fixture(scope="session")
def track_files() -> Path:
    """Recorded tracks without truth, as files of several formats."""
    return _published("trajectories/notruth", "recorded tracks")
