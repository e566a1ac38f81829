"""Answers about positions as rows: one per satellite and epoch, or one per epoch."""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

from estimators import Fix, Fixes
from service.positions.located import Located
from service.schemas.position_query import Rows

Column: TypeAlias = npt.NDArray[Any] | list[str]
_AXES = ("east", "north", "up")


def columns_of(located: Located, rows: Rows) -> dict[str, Column]:
    """Columns by name, without the times; numbers that are infinite or not there are NaN.

    Parameters
    ----------
    located : Located
    rows : {"satellites", "epochs"}

    Returns
    -------
    dict of str to ndarray or list of str
    """
    answer = located.answer
    if rows == "epochs":
        return _of_fix(answer) if isinstance(answer, Fix) else _of_fixes(answer)
    columns = _satellites(answer) if isinstance(answer, Fix) else _series_satellites(answer)
    if located.place is not None and isinstance(answer, Fixes):
        place = located.place
        columns = {
            name: [column[row] for row in place.tolist()] if isinstance(column, list) else column[place]
            for name, column in columns.items()
        }
    if located.row is not None:
        columns["row"] = located.row
    return columns


def epochs_of(located: Located, rows: Rows) -> npt.NDArray[np.int64]:
    """Of each row, its epoch."""
    answer = located.answer
    if rows == "epochs":
        return np.arange(1 if isinstance(answer, Fix) else len(answer))
    if isinstance(answer, Fix):
        return np.zeros(len(answer.satellites), dtype=np.int64)
    epoch = answer.satellites.epoch
    return epoch if located.place is None else epoch[located.place]


def _satellites(fix: Fix) -> dict[str, Column]:
    inner = fix.satellites
    return {
        "satellite": list(inner.name),
        "system": list(inner.system),
        "status": list(inner.status),
        "fault_probability": _finite(inner.fault_probability),
        "weight": _finite(inner.weight),
        "residual_m": _finite(inner.residual_m),
        "sigma_m": _finite(inner.sigma_m),
        "statistic": _finite(inner.statistic),
        "mdb_m": _finite(inner.mdb_m),
        "azimuth_deg": _finite(inner.azimuth_deg),
        "elevation_deg": _finite(inner.elevation_deg),
        "reason": list(inner.reason),
    }


def _series_satellites(fixes: Fixes) -> dict[str, Column]:
    inner = fixes.satellites
    return {
        "epoch": inner.epoch,
        "satellite": list(inner.name),
        "system": list(inner.system),
        "status": list(inner.status),
        "inlier": inner.inlier,
        "fault_probability": _finite(inner.fault_probability),
        "weight": _finite(inner.weight),
        "residual_m": _finite(inner.residual_m),
        "sigma_m": _finite(inner.sigma_m),
        "reason": list(inner.reason),
    }


def _of_fix(fix: Fix) -> dict[str, Column]:
    place = fix.geodetic
    numbers = {f"{axis}_m": fix.position_ecef_m[j] for j, axis in enumerate("xyz")}
    numbers |= {"lat_deg": place.lat_deg, "lon_deg": place.lon_deg, "height_m": place.height_m}
    numbers |= {f"sigma_{axis}_m": np.sqrt(fix.covariance_enu_m2[j, j]) for j, axis in enumerate(_AXES)}
    numbers |= {"hpl_m": fix.hpl_m, "vpl_m": fix.vpl_m, "far_probability": fix.far_probability}
    clocks = {f"clock_{letter}_m": value for letter, value in fix.clocks_m.items()}
    return (
        {"status": ["solved"]}
        | {name: _finite(np.array([value])) for name, value in numbers.items()}
        | {"ambiguous": np.array([fix.ambiguous])}
        | {name: _finite(np.array([value])) for name, value in clocks.items()}
    )


def _of_fixes(fixes: Fixes) -> dict[str, Column]:
    columns: dict[str, Column] = {"status": list(fixes.status)}
    columns |= {f"{axis}_m": _finite(fixes.position_ecef_m[:, j]) for j, axis in enumerate("xyz")}
    columns |= {
        name: _finite(fixes.geodetic[:, j]) for j, name in enumerate(("lat_deg", "lon_deg", "height_m"))
    }
    columns |= {f"{axis}_mps": _finite(fixes.velocity_enu_mps[:, j]) for j, axis in enumerate(_AXES)}
    columns |= {
        f"sigma_{axis}_m": _finite(np.sqrt(fixes.covariance_enu_m2[:, j, j])) for j, axis in enumerate(_AXES)
    }
    columns |= {
        "hpl_m": _finite(fixes.hpl_m),
        "vpl_m": _finite(fixes.vpl_m),
        "far_probability": _finite(fixes.far_probability),
        "ambiguous": fixes.ambiguous,
    }
    return columns | {f"clock_{letter}_m": _finite(column) for letter, column in fixes.clocks_m.items()}


def _finite(values: npt.NDArray[Any]) -> npt.NDArray[np.float64]:
    """Floats, NaN where one is infinite."""
    return np.where(np.isfinite(values), values, np.nan)
