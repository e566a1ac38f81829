"""A caller who leaves does not keep a long track in the works."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from estimators import clean_trajectory
from estimators.consensus.cancellation import Cancelled, cancelled_by
from estimators.trajectories import course
from estimators.trajectories.methods import whole_track
from estimators.trajectories.smoothing import blocks
from tests.trajectories.drives import MUNICH, drive

MADE = drive(3, n=600)


def columns() -> tuple[Any, ...]:
    return (MADE.t, *MUNICH.locate(MADE.fixes))


@pytest.mark.parametrize("method", ["auto", "ransac", "kalman", "speed-gate"])
def test_the_callers_flag_ends_the_work(method: str) -> None:
    with cancelled_by(np.ones(1, dtype=np.uint8)), pytest.raises(Cancelled):
        clean_trajectory(*columns(), method=method)


@pytest.mark.parametrize(
    ("module", "kernel"), [(whole_track, "Passage"), (blocks, "smooth_piece")], ids=["beam", "smoother"]
)
def test_a_flag_set_while_a_long_track_is_worked_on_ends_it_at_the_next_piece(
    module: Any, kernel: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    flag, calls = np.zeros(1, dtype=np.uint8), []
    original: Callable[..., Any] = getattr(module, kernel)

    def last(*arguments: Any, **named: Any) -> Any:
        calls.append(1)
        flag[0] = 1
        return original(*arguments, **named)

    monkeypatch.setattr(module, kernel, last)
    monkeypatch.setattr(whole_track, "_PIECE", 100)
    monkeypatch.setattr(course, "Smoothing", lambda *given: blocks.Smoothing(*given[:-1], 100))
    with cancelled_by(flag), pytest.raises(Cancelled):
        clean_trajectory(*columns())
    assert len(calls) == 1
