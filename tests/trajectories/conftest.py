"""Where the published tracks are."""

from __future__ import annotations

import os
from pathlib import Path

import pytest


@pytest.fixture(scope="session")
def track_data() -> Path:
    """Folder of the tracks; ``PLUMBLINE_TEST_DATA`` names the folder that holds ``trajectories``."""
    beside = Path(__file__).resolve().parents[3] / "shared" / "data"
    folder = Path(os.environ.get("PLUMBLINE_TEST_DATA", beside)) / "trajectories"
    if not folder.is_dir():
        pytest.skip("the published tracks are not here; PLUMBLINE_TEST_DATA says where they are")
    return folder
