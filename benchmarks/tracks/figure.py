"""The picture of the page: error over the oracle's, by groups, Plumbline beside its peers."""

from __future__ import annotations

from collections.abc import Sequence
from math import isnan
from pathlib import Path

import matplotlib as mpl
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from benchmarks.figure import OURS_COLOR, PEER_STYLES
from benchmarks.tracks.measure import Cell, pool
from benchmarks.tracks.page import OURS, RAW

_METHOD = "Plumbline "


def save_errors(cells: Sequence[Cell], path: Path) -> None:
    """Write the picture as SVG, without a date and with ids that do not change from run to run."""
    groups = list(dict.fromkeys(cell.group for cell in cells))
    # Our other methods are there to compare with, and stand in the tables.
    told = dict.fromkeys(cell.contender for cell in cells)
    names = [name for name in told if name == OURS or not name.startswith(_METHOD)]
    with mpl.rc_context({"svg.hashsalt": "plumbline", "font.size": 10.0}):
        figure = Figure(figsize=(10.0, 5.2), layout="constrained")
        FigureCanvasAgg(figure)
        axes = figure.subplots()
        peers = iter(PEER_STYLES)
        styles = {OURS: (OURS_COLOR, "o"), RAW: ("#222222", "_")}
        styles |= {name: next(peers) for name in names if name not in styles}
        for name in names:
            ours = name == OURS
            color, marker = styles[name]
            found = [
                (k, ratio)
                for k, group in enumerate(groups)
                if not isnan(ratio := pool(cells, group=group, contender=name).over_oracle)
            ]
            axes.plot(
                [k for k, _ in found],
                [ratio for _, ratio in found],
                linestyle="none",
                color=color,
                marker=marker,
                markersize=10.0 if ours else 6.0,
                zorder=3 if ours else 2,
                label=name,
            )
        axes.axhline(1.0, color="#444444", linewidth=0.8)
        axes.set_yscale("log")
        axes.set_ylabel("RMSE over the oracle's, geometric mean")
        axes.set_xticks(range(len(groups)), groups)
        axes.grid(axis="y", color="#dddddd", linewidth=0.8)
        for side in ("top", "right"):
            axes.spines[side].set_visible(False)
        axes.legend(frameon=False, fontsize=9.0, loc="upper center", bbox_to_anchor=(0.5, -0.08), ncols=3)
        figure.savefig(path, format="svg", metadata={"Date": None})
