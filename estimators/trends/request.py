"""What a shape of trend is asked to fit: the checked series and every setting of the fit."""

from __future__ import annotations

from dataclasses import dataclass, field

from estimators.consensus.presets import Preset
from estimators.options import RobustOptions
from estimators.result import NoFit, NoFitReason
from estimators.series import Series
from estimators.trends.bases.settings import Basis
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
    uncertainty : str
        One of :data:`estimators.trends.resampling.UNCERTAINTIES`.
    noise : {"auto", "multiplicative", "additive"}
        Of an exponential; other shapes take no notice of it.
    basis : Basis
        Degree, seasons and own columns.
    regime : {"all", "last"}
        Whether to fit the whole series or its present regime.
    """

    series: Series
    preset: Preset
    threshold: float | None
    sigma: float | None
    level: float
    seed: int
    options: RobustOptions
    uncertainty: str = "effective-n"
    noise: str = "auto"
    basis: Basis = field(default_factory=Basis)
    regime: str = "all"


def no_fit(reason: NoFitReason, message: str, series: Series) -> NoFit:
    """Say that nothing could be fitted, row by row."""
    points, notices = unlabelled_rows(series), input_notices(series)
    return NoFit(reason, message, points, notices, series.input_time, series.input_values)
