"""Programs that are no Python packages and that some tests call."""

from __future__ import annotations

import os
import shutil

import pytest


def require_program(name: str) -> str:
    """Path of a program; where it is missing, skip on a user's machine and fail in CI."""
    found = shutil.which(name)
    if found is None:
        reason = f"{name} is not installed"
        if os.environ.get("CI"):
            pytest.fail(f"{reason}; .ci/run has to install it")
        pytest.skip(reason)
    return found
