"""A track in words, 80 columns wide: how many fixes lie, how far it goes, and what to do about it."""

from __future__ import annotations

import html
from collections import Counter
from collections.abc import Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np

from estimators.notices import NoticeCode
from estimators.presentation.text import WIDTH, labelled

if TYPE_CHECKING:
    from estimators.trajectories.track import Track

_LABEL = 13
_STRETCHES_SHOWN = 6

ADVICE: Mapping[NoticeCode, str] = MappingProxyType(
    {
        NoticeCode.few_fixes: "Take the positions for what they are: measurements nobody checked.",
        NoticeCode.drift_unobservable: (
            "Compare with a map or a second receiver where metres matter; positions alone cannot tell."
        ),
        NoticeCode.sampling_too_sparse: "Send fixes more often, or with their reported accuracy.",
        NoticeCode.mostly_faulty: (
            "Look at the map before relying on the track; give accuracy_m if the receiver reports it."
        ),
        NoticeCode.clock_jumped: "Mend the clock of the receiver; the rows were put where the file has them.",
        NoticeCode.stale_positions: "Ask the receiver for the age of its fixes; drop old ones at the source.",
        NoticeCode.long_gaps: "Do not trust the line across a gap, nor the distance along it.",
        NoticeCode.invalid_rows: "Look at the rows with reason invalid; they take no part.",
    }
)
"""What to do about a notice."""


def _facts(track: Track) -> list[tuple[str, str]]:
    points = track.points
    counts = Counter(points.reason)
    told = ", ".join(f"{count:,} {name}" for name, count in counts.most_common())
    facts = [
        ("Fixes", f"{int(points.inlier.sum()):,} of {len(track):,} follow the track: {told}"),
        (
            "Noise",
            f"{track.noise.sigma_m:.3g} m per axis ({track.noise.source}), and "
            f"{track.noise.coloured_m:.3g} m that lasts for {track.noise.correlation_s:g} s",
        ),
    ]
    sigma = track.sigma_m[np.isfinite(track.sigma_m)]
    if sigma.size:
        facts.append(
            ("Std. error", f"{np.median(sigma):.3g} m per axis (median), {sigma.max():.3g} m at worst")
        )
    cleaned = track.distance.cleaned
    limits = "" if cleaned.low is None else f" ({cleaned.low:,.0f} to {cleaned.high:,.0f})"
    facts.append(
        ("Distance", f"{cleaned.value:,.0f} m{limits}; along the raw fixes {track.distance.raw_m:,.0f} m")
    )
    for item in track.stretches[:_STRETCHES_SHOWN]:
        text = f"{item.duration_s:,.0f} s"
        if item.kind == "moving":
            text += f", {item.distance_m:,.0f} m, median speed {item.speed_mps:.2f} m/s"
        facts.append((item.kind.capitalize(), text))
    if len(track.stretches) > _STRETCHES_SHOWN:
        facts.append(("", f"and {len(track.stretches) - _STRETCHES_SHOWN} further stretches"))
    return facts


def _notes(track: Track) -> list[str]:
    return [f"{item.message} {ADVICE.get(item.code, '')}".rstrip() for item in track.notices]


def track_to_text(track: Track) -> str:
    """Text for people.

    Parameters
    ----------
    track : Track

    Returns
    -------
    str
        Without a newline at the end.
    """
    lines = [f"Track by {track.method}", "━" * WIDTH]
    for label, sentence in _facts(track):
        lines += labelled(label, sentence, _LABEL)
    if track.notices:
        lines.append("─" * WIDTH)
    for note in _notes(track):
        lines += labelled("Note", note, _LABEL)
    return "\n".join(lines)


def track_to_html(track: Track) -> str:
    """Table for a notebook: escaped, without scripts."""
    rows = [*_facts(track), *(("Note", note) for note in _notes(track))]
    cells = "\n".join(
        f'<tr><th style="text-align:left">{html.escape(label)}</th>'
        f'<td style="text-align:left">{html.escape(text)}</td></tr>'
        for label, text in rows
    )
    title = html.escape(f"Track by {track.method}")
    caption = f'<caption style="text-align:left"><b>{title}</b></caption>'
    return f'<table class="plumbline">\n{caption}\n{cells}\n</table>'
