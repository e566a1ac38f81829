"""Shared fixtures: where the published data sets are."""

from __future__ import annotations

import os
from pathlib import Path

import pytest


@pytest.fixture(scope="session")
def trend_data() -> Path:
    """Folder of the published trend data; ``PLUMBLINE_TEST_DATA`` names the folder that holds ``trends``."""
    beside = Path(__file__).resolve().parents[2] / "shared" / "data"
    folder = Path(os.environ.get("PLUMBLINE_TEST_DATA", beside)) / "trends"
    if not folder.is_dir():
        pytest.skip("the published data sets are not here; PLUMBLINE_TEST_DATA says where they are")
    return folder


@pytest.fixture(scope="session")
def gnss_data() -> Path:
    """Folder of the recorded pseudoranges; ``PLUMBLINE_TEST_DATA`` names the folder that holds ``gnss``."""
    beside = Path(__file__).resolve().parents[2] / "shared" / "data"
    folder = Path(os.environ.get("PLUMBLINE_TEST_DATA", beside)) / "gnss"
    if not folder.is_dir():
        pytest.skip("the recorded pseudoranges are not here; PLUMBLINE_TEST_DATA says where they are")
    return folder
