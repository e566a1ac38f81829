"""Robust estimation for contaminated measurements: numpy in, frozen dataclasses out."""

from collections.abc import Mapping
from importlib.metadata import version

from estimators.arrays import InputError
from estimators.consensus.presets import PRESETS, Preset
from estimators.options import RobustOptions
from estimators.result import Estimate, NoFit, NoFitReason, Notice, NoticeCode
from estimators.trends.fit import fit_trend
from estimators.trends.models import MODELS, TrendModel
from estimators.trends.trend import Prediction, Trend

__all__ = [
    "Estimate",
    "InputError",
    "NoFit",
    "NoFitReason",
    "Notice",
    "NoticeCode",
    "Prediction",
    "Preset",
    "RobustOptions",
    "Trend",
    "TrendModel",
    "__version__",
    "fit_trend",
    "methods",
    "models",
]

__version__ = version("plumbline")


def methods() -> Mapping[str, Preset]:
    """Return the named methods, ``auto`` first: what ``method=`` takes."""
    return PRESETS


def models() -> Mapping[str, TrendModel]:
    """Return the shapes a trend can have: what ``model=`` takes."""
    return MODELS
