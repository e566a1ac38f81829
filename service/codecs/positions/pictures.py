"""Pictures of positions, SVG and PNG, drawn by :mod:`estimators.adapters.position_plots`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

from estimators import Fix
from estimators.geodesy.ellipsoid import to_cartesian
from estimators.geodesy.local_frame import enu_axes
from service.errors import Problem, ProblemType, invalid_value
from service.positions.located import Located
from service.schemas.position_query import TRUTH, PositionAnswerQuery

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def write_svg(located: Located, query: PositionAnswerQuery) -> bytes:
    """Picture as SVG; the same answer gives the same bytes."""
    return _draw(located, query, "svg")


def write_png(located: Located, query: PositionAnswerQuery) -> bytes:
    """Picture as PNG."""
    return _draw(located, query, "png")


def check_picture(query: PositionAnswerQuery, *, many: bool) -> None:
    """Refuse before the work what cannot be drawn after it.

    Parameters
    ----------
    query : PositionAnswerQuery
    many : bool
        Whether there is more than one epoch.

    Raises
    ------
    Problem
        422 if the picture shows one epoch and there are more, or needs a truth that was not given.
    """
    if query.figure != "stanford":
        if many:
            raise invalid_value(
                "figure",
                f"the picture {query.figure} shows one epoch; send one, or ask for figure=stanford "
                "or another format",
            )
        return
    absent = next((name for name in TRUTH if getattr(query, name) is None), None)
    if absent is not None:
        raise invalid_value(absent, f"is needed for errors; send {', '.join(TRUTH)} of the receiver")


def _draw(located: Located, query: PositionAnswerQuery, file_format: Literal["svg", "png"]) -> bytes:
    # Matplotlib takes longer to import than the whole service; who asks for no picture does not wait for it.
    from estimators.adapters.plotting import render  # noqa: PLC0415

    return render(_figure(located, query), file_format)


def _figure(located: Located, query: PositionAnswerQuery) -> Figure:
    from estimators.adapters import position_plots  # noqa: PLC0415

    size = {"width_px": query.width_px, "height_px": query.height_px}
    answer = located.answer
    if query.figure == "stanford":
        error, level = _errors(located, query)
        return position_plots.stanford_figure(
            error, level, located.alert_m, theme=query.theme, title=query.title, **size
        )
    if not isinstance(answer, Fix):
        raise TypeError("a series is no single epoch; check_picture comes first")
    draw = position_plots.sky_figure if query.figure == "sky" else position_plots.residual_figure
    return draw(answer, theme=query.theme, title=query.title, **size)


def _errors(located: Located, query: PositionAnswerQuery) -> tuple[np.ndarray, np.ndarray]:
    """Horizontal errors of the epochs, and their protection levels."""
    answer = located.answer
    lat, lon, height = (float(getattr(query, name)) for name in TRUTH)
    truth = to_cartesian(np.array([lat, lon, height]))
    east_north = (np.atleast_2d(answer.position_ecef_m) - truth) @ enu_axes(lat, lon)[:2].T
    error = np.hypot(east_north[:, 0], east_north[:, 1])
    level = np.atleast_1d(answer.hpl_m)
    if not np.any(np.isfinite(error) & np.isfinite(level)):
        raise Problem(
            ProblemType.no_position, "no epoch has a finite protection level, so that there is none to draw"
        )
    return error, level
