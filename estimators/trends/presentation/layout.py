"""A report set as text for an 80-column terminal, and as HTML for a notebook."""

from __future__ import annotations

import html
import textwrap
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from estimators.presentation.text import WIDTH, labelled

if TYPE_CHECKING:
    from estimators.trends.presentation.report import Report

_LABEL = 12
_HTML_COLUMNS = 5


def to_text(report: Report) -> str:
    """Set a report as plain text, at most 80 columns wide where its words allow.

    Parameters
    ----------
    report : Report

    Returns
    -------
    str
        Without a newline at the end.
    """
    thin = "─" * WIDTH
    lines = [
        report.title,
        "━" * WIDTH,
        *_equation(report.equation),
        "",
        *_columns(estimate_rows(report)),
        thin,
    ]
    for label, sentence in report.facts:
        lines += labelled(label, sentence, _LABEL)
    if report.outliers:
        lines += [thin, *_columns([outlier_titles(report), *report.outliers])]
    if report.predictions:
        lines += [thin, *_columns([prediction_titles(report), *report.predictions])]
    if report.notices:
        lines.append(thin)
    for message, advice in report.notices:
        lines += labelled("Note", f"{message} {advice}".rstrip(), _LABEL)
    return "\n".join(lines)


def estimate_rows(report: Report) -> list[tuple[str, str, str, str, str]]:
    """Table of the parameters, its titles first."""
    rows = [("", "estimate", "std. error", f"{report.level} interval", "p-value")]
    rows += [(item.name, item.value, item.stderr, item.interval, item.p_value) for item in report.estimates]
    return rows


def outlier_titles(report: Report) -> tuple[str, str, str]:
    """Titles of the outliers' columns: how many there are, and how many of them are listed."""
    total, shown = report.outliers_total, len(report.outliers)
    count = f"{total:,} outlier{'s' if total > 1 else ''}"
    return f"{count}, farthest {shown}" if total > shown else count, "value", "off the trend"


def prediction_titles(report: Report) -> tuple[str, str, str, str]:
    """Titles of a prediction's columns: the bands of the trend and of a new reading are two things."""
    total, shown = report.predictions_total, len(report.predictions)
    first = "Prediction at" if total == shown else f"First {shown} of {total:,} predictions"
    return first, "trend", f"{report.level} of the trend", f"{report.level} of a reading"


def _columns(rows: Sequence[Sequence[str]]) -> list[str]:
    """Set cells under one another: the first column to the left, the others to the right."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    gap = " " * min(3, max(1, (WIDTH - sum(widths)) // (len(widths) - 1)))
    lines = []
    for first, *others in rows:
        right = (cell.rjust(width) for cell, width in zip(others, widths[1:], strict=True))
        lines.append(gap.join([first.ljust(widths[0]), *right]).rstrip())
    return lines


def _equation(text: str) -> list[str]:
    return textwrap.wrap(text, WIDTH, initial_indent="  ", subsequent_indent="      ", break_long_words=False)


def to_html(report: Report) -> str:
    """Set a report as one HTML table: escaped, without scripts, in the colours of the page around it.

    Parameters
    ----------
    report : Report

    Returns
    -------
    str
    """
    titles, *estimates = estimate_rows(report)
    parts = [
        '<table class="plumbline">',
        f'<caption style="text-align:left"><b>{html.escape(report.title)}</b><br>'
        f"<code>{html.escape(report.equation)}</code></caption>",
        _row(titles, "th"),
        *(_row(cells, "td") for cells in estimates),
        *(_fact(label, sentence) for label, sentence in report.facts),
    ]
    if report.outliers:
        parts += [_row(outlier_titles(report), "th"), *(_row(cells, "td") for cells in report.outliers)]
    if report.predictions:
        parts += [_row(prediction_titles(report), "th"), *(_row(cells, "td") for cells in report.predictions)]
    parts += [_fact("Note", f"{message} {advice}".rstrip()) for message, advice in report.notices]
    parts.append("</table>")
    return "\n".join(parts)


def _row(cells: Iterable[str], tag: str) -> str:
    """Row of a table; its last cell spans the columns that are left."""
    texts = [html.escape(cell) for cell in cells]
    sides = ["left"] + ["right"] * (len(texts) - 1)
    rest = _HTML_COLUMNS - len(texts)
    spans = [""] * (len(texts) - 1) + [f' colspan="{rest + 1}"' if rest else ""]
    body = "".join(
        f'<{tag} style="text-align:{side}"{span}>{text}</{tag}>'
        for side, span, text in zip(sides, spans, texts, strict=True)
    )
    return f"<tr>{body}</tr>"


def _fact(label: str, sentence: str) -> str:
    return (
        f'<tr><th style="text-align:left">{html.escape(label)}</th>'
        f'<td style="text-align:left" colspan="{_HTML_COLUMNS - 1}">{html.escape(sentence)}</td></tr>'
    )
