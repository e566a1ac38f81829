"""The picture of the benchmark: failures over the share of outliers, Plumbline beside its peers."""

from __future__ import annotations

from pathlib import Path

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from benchmarks.accuracy import SHARES, Accuracy
from benchmarks.cells import Outcomes
from benchmarks.contenders import Contender

OURS_COLOR = "#0b5cad"
PEER_STYLES = (
    ("#c2571a", "s"),
    ("#7a5195", "D"),
    ("#2f8f5b", "^"),
    ("#b5890a", "v"),
    ("#d1495b", "P"),
    ("#3f9aa8", "X"),
    ("#8c6d4f", "<"),
    ("#777777", ">"),
)
"""Color and marker of a peer, so that the lines can be told apart without colors too."""


def save_failures(accuracy: Accuracy, path: Path) -> None:
    """Write the picture as SVG, without a date and with ids that do not change from run to run."""
    with mpl.rc_context({"svg.hashsalt": "plumbline", "font.size": 10.0}):
        figure = Figure(figsize=(11.0, 5.6), layout="constrained")
        FigureCanvasAgg(figure)
        free, given = figure.subplots(1, 2, sharey=True)
        _panel(free, accuracy, knows_threshold=False)
        _panel(given, accuracy, knows_threshold=True)
        free.set_title("Nobody tells the noise", loc="left", fontsize=11)
        given.set_title("Threshold given: 2.7 true sigma", loc="left", fontsize=11)
        free.set_ylabel("wrong lines, % (mean over kinds of outliers)")
        figure.savefig(path, format="svg", metadata={"Date": None})


def _panel(axes: Axes, accuracy: Accuracy, *, knows_threshold: bool) -> None:
    percents = [100.0 * share for share in SHARES]
    names = list(dict.fromkeys(entry.name for entry in accuracy.contenders if not _is_ours(entry)))
    for index, contender in enumerate(accuracy.contenders):
        if contender.knows_threshold is not knows_threshold:
            continue
        rates = accuracy.by_share(index, Outcomes.fail_percent)
        ours = _is_ours(contender)
        color, marker = (OURS_COLOR, "o") if ours else PEER_STYLES[names.index(contender.name)]
        axes.plot(
            percents,
            rates,
            color=color,
            linewidth=3.0 if ours else 1.3,
            marker=marker,
            markersize=7.0 if ours else 4.5,
            zorder=3 if ours else 2,
            label=contender.name,
        )
    axes.set_xlabel("outliers, %")
    axes.set_xticks(percents)
    axes.set_ylim(-2.0, 102.0)
    axes.grid(axis="y", color="#dddddd", linewidth=0.8)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    axes.legend(frameon=False, fontsize=9.0, loc="upper center", bbox_to_anchor=(0.5, -0.13), ncols=2)


def _is_ours(contender: Contender) -> bool:
    return contender.name.startswith("Plumbline")
