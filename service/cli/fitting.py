"""``plumbline fit``: a file to a trend, as a readable table, JSON or CSV, and a picture if asked for."""

from __future__ import annotations

import dataclasses
import difflib
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np
import typer

import estimators
from estimators import InputError, NoFit, RobustOptions, Trend
from estimators.trends.presentation.layout import to_text
from estimators.trends.presentation.report import describe
from service.cli.moments import read_moment_like
from service.cli.streams import NO_TREND, answers, fail, remark
from service.cli.tables import show_report
from service.codecs.csv import write_csv
from service.codecs.json import dumps, write_json
from service.codecs.table import Table, TableError, read_delimiter, read_table
from service.schemas.fields import TimeUnit
from service.schemas.options import AnswerQuery, read_periods

if TYPE_CHECKING:
    from estimators.adapters.plotting import FigureFormat, Theme

PICTURES: dict[str, FigureFormat] = {".png": "png", ".svg": "svg"}

# How the options are called that the library knows by another name.
_OPTION_OF = {
    "t": "the time column",
    "y": "the value column",
    "weights": "the weight column",
    "columns": "--column",
}


@dataclass(frozen=True, slots=True)
class FitRequest:
    """What the command line asks for; see ``plumbline fit --help``."""

    file: str
    time: str | None
    value: str | None
    weight: str | None
    delimiter: str | None
    time_unit: TimeUnit | None
    since: str | None
    until: str | None
    model: str
    method: str
    threshold: float | None
    sigma: float | None
    level: float
    seed: int
    predict: tuple[str, ...]
    plot: Path | None
    theme: Theme
    output: Literal["text", "json", "csv"]
    noise: str = "auto"
    uncertainty: str = "effective-n"
    resamples: int | None = None
    degree: int | None = None
    seasonal: tuple[str, ...] = ()
    harmonics: int | None = None
    regime: str = "all"
    reach: tuple[float, ...] = ()
    horizon: str | None = None
    column: tuple[str, ...] = ()


def run_fit(request: FitRequest, *, one_format: bool = True) -> None:
    """Fit and print; ends the command with code 1 or 2 where it cannot.

    Parameters
    ----------
    request : FitRequest
    one_format : bool
        Whether at most one format of output was asked for.
    """
    if not one_format:
        fail("--json and --csv exclude one another; ask for one of them.")
    _check_names(request)
    if request.plot is not None:
        _check_picture(request.plot)
    try:
        table = _read(request)
    except TableError as error:
        fail(f"{_source(request.file)}: {error}.")
    answer = _fit(request, table)
    for sentence in table.remarks:
        remark(sentence)
    if isinstance(answer, NoFit):
        if request.output == "json":
            typer.echo(dumps(answer.to_dict()))
        fail(f"{_source(request.file)}: no trend ({answer.reason.value}): {answer.message}", NO_TREND)
    _print(request, table, answer)
    if request.plot is not None:
        _draw(request.plot, request.theme, table, answer)


def _source(file: str) -> str:
    return "standard input" if file == "-" else file


def _check_picture(path: Path) -> None:
    """Refuse before the fit what cannot be written after it."""
    if path.suffix.lower() not in PICTURES:
        fail(f"--plot {path}: a picture is written as {' or '.join(PICTURES)}; change the ending.")
    if not path.parent.is_dir():
        fail(f"--plot {path}: there is no directory {path.parent}; make it, or choose another place.")


def _check_names(request: FitRequest) -> None:
    known = {
        "method": (request.method, list(estimators.methods())),
        "model": (request.model, list(estimators.models())),
    }
    for option, (asked, names) in known.items():
        if asked not in names:
            close = difflib.get_close_matches(asked.lower(), names, n=1)
            hint = f" (did you mean {close[0]}?)" if close else ""
            fail(
                f"--{option} {asked}: there is no such {option}{hint}; the {option}s are: {', '.join(names)}."
            )


def _read(request: FitRequest) -> Table:
    """Table of the file, cut to the times asked for, with the times to predict."""
    table = read_table(
        _bytes_of(request.file),
        time=request.time,
        value=request.value,
        weight=request.weight,
        own=request.column,
        delimiter=None if request.delimiter is None else read_delimiter(request.delimiter),
        time_unit=request.time_unit,
    )
    columns = table.columns
    kept = np.ones(columns.time.size, dtype=np.bool_)
    if request.since is not None:
        kept &= columns.time >= read_moment_like(columns, [request.since], "--since")[0]
    if request.until is not None:
        kept &= columns.time <= read_moment_like(columns, [request.until], "--until")[0]
    if not kept.any():
        raise TableError("no row is left to fit; check the file, --since and --until")
    predict = read_moment_like(columns, list(request.predict), "--predict") if request.predict else None
    horizon = None if request.horizon is None else read_moment_like(columns, [request.horizon], "--horizon")
    columns = dataclasses.replace(
        columns,
        horizon=horizon,
        time=columns.time[kept],
        value=columns.value[kept],
        weight=None if columns.weight is None else columns.weight[kept],
        predict=predict,
        own={name: column[kept] for name, column in columns.own.items()},
    )
    return dataclasses.replace(table, columns=columns)


def _bytes_of(file: str) -> bytes:
    if file == "-":
        return sys.stdin.buffer.read()
    path = Path(file)
    if path.is_dir():
        raise TableError("is a directory; give a file, or - for standard input")
    try:
        return path.read_bytes()
    except FileNotFoundError as error:
        raise TableError("there is no such file; check the name, or give - for standard input") from error
    except OSError as error:
        raise TableError(f"cannot be read ({error.strerror})") from error


def _fit(request: FitRequest, table: Table) -> Trend | NoFit:
    columns = table.columns
    try:
        options = RobustOptions() if request.resamples is None else RobustOptions(resamples=request.resamples)
        return estimators.fit_trend(
            columns.time,
            columns.value,
            weights=columns.weight,
            model=request.model,
            method=request.method,
            threshold=request.threshold,
            sigma=request.sigma,
            level=request.level,
            seed=request.seed,
            uncertainty=request.uncertainty,
            noise=request.noise,
            degree=request.degree,
            seasonal=read_periods(request.seasonal) if request.seasonal else None,
            harmonics=request.harmonics,
            columns=columns.own or None,
            regime=request.regime,
            reach=request.reach or None,
            horizon=columns.horizon,
            predict=columns.predict,
            options=options,
        )
    except InputError as error:
        fail(f"{_OPTION_OF.get(error.field, '--' + error.field.replace('_', '-'))}: {error.message}.")


def _print(request: FitRequest, table: Table, trend: Trend) -> None:
    if request.output == "json":
        typer.echo(write_json(trend, table.columns, AnswerQuery()))
    elif request.output == "csv":
        typer.echo(write_csv(trend, table.columns, AnswerQuery()), nl=False)
    else:
        report = describe(trend, time_name=table.time_name, value_name=table.value_name)
        console = answers()
        if console.is_terminal:
            show_report(console, report)
        else:
            typer.echo(to_text(report))


def _draw(path: Path, theme: Theme, table: Table, trend: Trend) -> None:
    # Matplotlib takes longer to import than everything else; who asks for no picture does not wait for it.
    from estimators.adapters.plotting import render, trend_figure  # noqa: PLC0415

    figure = trend_figure(
        trend,
        theme=theme,
        time_label=table.time_name if table.columns.form.kind == "number" else None,
        value_label=table.value_name,
    )
    try:
        path.write_bytes(render(figure, PICTURES[path.suffix.lower()]))
    except OSError as error:
        fail(f"--plot {path}: cannot be written ({error.strerror}); choose another place.")
    remark(f"Wrote {path}.")
