"""Compiled kernels are cached under the text that they were compiled from."""

from __future__ import annotations

import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest

from estimators import kernels, series
from estimators.kernels import Kernel


@pytest.fixture
def declared_again(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Any:
    monkeypatch.setenv("PLUMBLINE_CACHE_DIR", str(tmp_path))
    known = series.is_orderly
    return lambda: Kernel(known.__wrapped__, known._signature)


def test_a_kernel_is_read_from_the_cache_by_the_next_process(
    declared_again: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(kernels, "_STARTED_NS", time.time_ns())
    first, second = declared_again(), declared_again()
    first.load()
    second.load()
    assert (first.came_from_cache, second.came_from_cache) == (False, True)


def test_code_that_was_edited_while_the_process_ran_is_not_cached(
    declared_again: Any, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(kernels, "_STARTED_NS", 0)
    entry = declared_again()
    entry.load()
    assert entry.is_loaded
    assert not list(tmp_path.iterdir())


def test_importing_the_library_declares_every_kernel() -> None:
    script = (
        "import importlib, pkgutil, estimators\n"
        "from estimators import kernels\n"
        "at_once = kernels.declared()\n"
        "for module in pkgutil.walk_packages(estimators.__path__, 'estimators.'):\n"
        "    importlib.import_module(module.name)\n"
        "print(*sorted(set(kernels.declared()) - set(at_once)))\n"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == ""
