import os
from pathlib import Path

import pytest


@pytest.fixture(scope="session")
def track_files() -> Path:
    """Recorded tracks without truth; ``PLUMBLINE_TEST_DATA`` names the folder that holds ``trajectories``."""
    beside = Path(__file__).resolve().parents[4] / "shared" / "data"
    folder = Path(os.environ.get("PLUMBLINE_TEST_DATA", beside)) / "trajectories" / "notruth"
    if not folder.is_dir():
        pytest.skip("the recorded tracks are not here; PLUMBLINE_TEST_DATA says where they are")
    return folder
