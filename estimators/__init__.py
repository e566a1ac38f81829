"""Robust estimation for contaminated measurements: numpy in, frozen dataclasses out."""

from collections.abc import Mapping
from importlib.metadata import version

from estimators.arrays import InputError
from estimators.consensus.presets import PRESETS, Preset
from estimators.gnss.fix import Fix
from estimators.gnss.locate import locate
from estimators.gnss.methods.registry import POSITION_METHODS, PositionMethod
from estimators.gnss.options import PositionOptions
from estimators.gnss.orbits import states as _states  # noqa: F401  # kernels that only readers of files call
from estimators.gnss.raw import correct_ranges
from estimators.gnss.series.epochs import Epoch, Epochs
from estimators.gnss.series.fixes import EpochFix, Fixes
from estimators.gnss.series.locate_series import locate_series
from estimators.gnss.series.stream import locate_stream
from estimators.notices import Notice, NoticeCode
from estimators.options import RobustOptions
from estimators.result import Estimate, NoFit, NoFitReason
from estimators.trajectories.clean import clean_in_pieces, clean_trajectory
from estimators.trajectories.ellipse import accuracy_of_ellipse
from estimators.trajectories.live.answer import LiveRows, LiveTrack
from estimators.trajectories.live.clean_live import clean_live
from estimators.trajectories.methods.registry import TRACK_METHODS, TrackMethod
from estimators.trajectories.options import TrackOptions
from estimators.trajectories.track import Track
from estimators.trends.fit import fit_trend
from estimators.trends.many import fit_trends
from estimators.trends.models import MODELS, TrendModel
from estimators.trends.prediction import Prediction
from estimators.trends.questions.comparison import Difference
from estimators.trends.questions.crossing import Crossing
from estimators.trends.regimes.regime import Regime
from estimators.trends.table import TrendTable
from estimators.trends.trend import Trend

__all__ = [
    "Crossing",
    "Difference",
    "Epoch",
    "EpochFix",
    "Epochs",
    "Estimate",
    "Fix",
    "Fixes",
    "InputError",
    "LiveRows",
    "LiveTrack",
    "NoFit",
    "NoFitReason",
    "Notice",
    "NoticeCode",
    "PositionMethod",
    "PositionOptions",
    "Prediction",
    "Preset",
    "Regime",
    "RobustOptions",
    "Track",
    "TrackMethod",
    "TrackOptions",
    "Trend",
    "TrendModel",
    "TrendTable",
    "__version__",
    "accuracy_of_ellipse",
    "clean_in_pieces",
    "clean_live",
    "clean_trajectory",
    "correct_ranges",
    "fit_trend",
    "fit_trends",
    "locate",
    "locate_series",
    "locate_stream",
    "methods",
    "models",
    "position_methods",
    "track_methods",
]

__version__ = version("plumbline")


def methods() -> Mapping[str, Preset]:
    """Return the named methods, ``auto`` first: what ``method=`` takes."""
    return PRESETS


def models() -> Mapping[str, TrendModel]:
    """Return the shapes a trend can have: what ``model=`` takes."""
    return MODELS


def position_methods() -> Mapping[str, PositionMethod]:
    """Return the methods of fault exclusion, ``auto`` first: what ``method=`` of :func:`locate` takes."""
    return POSITION_METHODS


def track_methods() -> Mapping[str, TrackMethod]:
    """Return the methods of cleaning, ``auto`` first: what ``method=`` of :func:`clean_trajectory` takes."""
    return TRACK_METHODS
