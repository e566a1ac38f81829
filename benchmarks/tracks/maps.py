"""Maps for looking at: the raw track, the cleaned one and the truth."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from benchmarks.figure import OURS_COLOR
from benchmarks.tracks.recording import FAULTY, Recording
from benchmarks.tracks.scores import Answer

LOOKED_AT = (
    "city, clean",
    "train at 300 km/h, clean",
    "stationary, clean",
    "circle, spikes 40 %",
    "city, walking bursts 30 %",
    "walk, ramps 15 %",
    "stop and go, mixed 30 %",
    "city, wandering 30-90 s, 25 %",
    "walk, then a car, mixed 15 %",
    "city, stuck receiver",
)
"""Types of which maps are drawn on demand; the page shows four of them."""
SHOWN = LOOKED_AT[3:7]
_LEAST_M = 40.0


def save_maps(pairs: Sequence[tuple[Recording, Answer]], path: Path) -> None:
    """Draw tracks beside one another, two in a row, as PNG.

    Parameters
    ----------
    pairs : sequence of (Recording, Answer)
    path : pathlib.Path
    """
    rows = -(-len(pairs) // 2)
    with mpl.rc_context({"font.size": 9.0}):
        figure = Figure(figsize=(11.0, 5.0 * rows), layout="constrained")
        FigureCanvasAgg(figure)
        panels = figure.subplots(rows, 2, squeeze=False).ravel()
        for axes, (recording, answer) in zip(panels, pairs, strict=False):
            _panel(axes, recording, answer)
        for axes in panels[len(pairs) :]:
            axes.set_axis_off()
        figure.savefig(path, format="png", dpi=90, metadata={"Software": None})


def _panel(axes: Axes, recording: Recording, answer: Answer) -> None:
    order = np.argsort(recording.t_s, kind="stable")
    truth = recording.plane_m(recording.true_lat_deg, recording.true_lon_deg)[order]
    raw = recording.plane_m(recording.lat_deg, recording.lon_deg)[order]
    cleaned = recording.plane_m(answer.lat_deg, answer.lon_deg)[order]
    faulty = recording.label[order] == FAULTY
    flagged = np.zeros(len(recording), dtype=np.bool_) if answer.flagged is None else answer.flagged[order]
    axes.plot(*raw.T, color="#bbbbbb", linewidth=0.6, zorder=1)
    for rows, color, marker, label in (
        (~faulty & ~flagged, "#777777", ".", "fix"),
        (faulty & flagged, "#d1495b", ".", "fault, flagged"),
        (faulty & ~flagged, "#d1495b", "x", "fault, missed"),
        (~faulty & flagged, "#b5890a", "+", "good, flagged"),
    ):
        if rows.any():
            axes.plot(*raw[rows].T, linestyle="none", color=color, marker=marker, markersize=4.0, label=label)
    axes.plot(*truth.T, color="#111111", linewidth=2.2, label="truth", zorder=3)
    axes.plot(*cleaned.T, color=OURS_COLOR, linewidth=1.2, label="cleaned", zorder=4)
    low, high = np.nanmin(truth, axis=0), np.nanmax(truth, axis=0)
    middle = 0.5 * (low + high)
    # A square, so that both axes have one scale; far faults lie outside.
    half = max(0.6 * float(np.max(high - low)), _LEAST_M)
    axes.set_xlim(middle[0] - half, middle[0] + half)
    axes.set_ylim(middle[1] - half, middle[1] + half)
    axes.set_aspect("equal")
    axes.set_title(recording.name, loc="left", fontsize=10)
    axes.set_xlabel("east, m")
    axes.set_ylabel("north, m")
    axes.legend(frameon=False, fontsize=8.0)
