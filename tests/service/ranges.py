"""Pseudoranges with a known position and a known liar, as the wire carries them."""

from __future__ import annotations

from typing import Any

import numpy as np

from estimators.geodesy.ellipsoid import to_cartesian

HERE = to_cartesian(np.array([52.5, 13.4, 80.0]))
SKY = [[60, 10], [20, -30], [48, 40], [75, 100], [30, 60], [52, -10], [40, 13], [65, -50], [35, -60]]
NAMES = [f"G{k:02d}" for k in range(1, 10)]
LIAR = 3


def epoch(fault_m: float = 250.0, seed: int = 1, **fields: Any) -> dict[str, Any]:
    """Columns of one epoch of nine satellites, of which the fourth lies."""
    satellites = to_cartesian(np.array([[lat, lon, 20.2e6] for lat, lon in SKY]))
    ranges = np.linalg.norm(satellites - HERE, axis=1) + 1500.0
    ranges += np.random.default_rng(seed).normal(size=9)
    ranges[LIAR] += fault_m
    columns = {name: satellites[:, k].tolist() for k, name in enumerate(("x_m", "y_m", "z_m"))}
    return {**columns, "pseudorange_m": ranges.tolist(), "satellite": NAMES, "rotated": True, **fields}


def epochs(count: int = 3, step: float = 30.0) -> dict[str, Any]:
    """Columns of several epochs, one after the other."""
    parts = [epoch(seed=k) for k in range(count)]
    joined: dict[str, Any] = {
        name: [item for part in parts for item in part[name]] for name in parts[0] if name != "rotated"
    }
    return {**joined, "time": [step * k for k in range(count) for _ in NAMES], "rotated": True}


def as_csv(fields: dict[str, Any]) -> str:
    """Columns as a CSV table; what is no column is left out."""
    columns = {name: column for name, column in fields.items() if isinstance(column, list)}
    lines = [",".join(str(cell) for cell in row) for row in zip(*columns.values(), strict=True)]
    return "\n".join([",".join(columns), *lines, ""])
