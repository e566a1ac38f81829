"""What a shape of trend is asked to fit: the checked series and every setting of the fit."""

from __future__ import annotations

from dataclasses import dataclass

from estimators.consensus.presets import Preset
from estimators.options import RobustOptions
from estimators.result import NoFit, NoFitReason
from estimators.series import Series
from estimators.trends.labels import unlabelled_rows
from estimators.trends.observations import input_notices


@dataclass(frozen=True, slots=True)
class Request:
    """A fit that was asked for; every argument is checked.

    Attributes
    ----------
    series : Series
        Usable points in ascending time, with what became of every input row.
    preset : Preset
    threshold, sigma : float or None
        In units of ``series.y``.
    level : float
    seed : int
    options : RobustOptions
    """

    series: Series
    preset: Preset
    threshold: float | None
    sigma: float | None
    level: float
    seed: int
    options: RobustOptions


def no_fit(reason: NoFitReason, message: str, series: Series) -> NoFit:
    """Say that nothing could be fitted, row by row."""
    points, notices = unlabelled_rows(series), input_notices(series)
    return NoFit(reason, message, points, notices, series.input_time, series.input_values)
