"""A robust trend per pixel of an xarray.DataArray, lazily where it is chunked with dask (extra ``[xarray]``).

Every pixel is one series of :func:`estimators.fit_trends`; which chunk it stands in changes no byte.
"""

from __future__ import annotations

from collections.abc import Hashable
from typing import Any

import numpy as np
import xarray as xr

from estimators.arrays import BoolArray, FloatArray, InputError
from estimators.options import RobustOptions
from estimators.trends.fit import fit_trend
from estimators.trends.many import fit_trends
from estimators.trends.presentation.units import moment_text

SECONDS_PER = {"second": 1.0, "minute": 60.0, "hour": 3600.0, "day": 86400.0, "year": 365.25 * 86400.0}
"""Units in which a slope over points in time can be stated; the year is the Julian one."""

_OUTPUTS = (
    "slope",
    "slope_stderr",
    "slope_low",
    "slope_high",
    "intercept",
    "p_value",
    "inlier_ratio",
    "sigma",
)

_OF_THE_VALUES = ("units", "long_name", "standard_name", "valid_min", "valid_max", "valid_range")
"""Attributes that describe the values and not where they come from."""


def robust_trend(
    data: xr.DataArray,
    dim: Hashable = "time",
    *,
    method: str = "auto",
    threshold: float | None = None,
    sigma: float | None = None,
    weights: xr.DataArray | None = None,
    level: float = 0.95,
    seed: int = 0,
    per: str | None = None,
    options: RobustOptions | None = None,
) -> xr.Dataset:
    """Fit a line that outliers cannot move along one dimension, for every pixel.

    Parameters
    ----------
    data : DataArray
        Numbers; NaN is missing. If it is chunked, nothing is computed until it is asked for; chunks along
        ``dim`` are joined, and the other dimensions then cut into chunks of dask's own choice.
    dim : hashable
        Dimension of time (default ``"time"``). Its coordinate may be numbers or datetime64; without one the
        times are 0, 1, 2, ...
    method, threshold, sigma, level, seed, options
        As in :func:`estimators.fit_trend`, for all pixels.
    weights : DataArray, optional
        Precisions, 1/variance up to a common factor, along ``dim`` or of the shape of the data.
    per : {"second", "minute", "hour", "day", "year"}, optional
        Unit of time of the slope where the times are points in time (default second; a year has 365.25 days).

    Returns
    -------
    Dataset
        float64, without ``dim``: ``slope`` with ``slope_stderr``, ``slope_low`` and ``slope_high``,
        ``intercept`` (at the first time, or at 0 for plain numbers), ``p_value`` of "the slope is zero",
        ``inlier_ratio`` and ``sigma``. NaN where a pixel has no trend. Attributes of the data are kept;
        ``units`` follow from theirs.

    Raises
    ------
    InputError
        If an argument cannot be used, cftime dates among them; ``field`` names it.

    Examples
    --------
    >>> import numpy as np
    >>> import xarray as xr
    >>> values = np.add.outer([0.0, 5.0], 2.0 * np.arange(24.0))
    >>> values[:, [3, 11, 12]] += 40.0
    >>> cube = xr.DataArray(values, dims=["station", "time"], attrs={"units": "mm"})
    >>> robust_trend(cube).slope.values.round(6)
    array([2., 2.])
    """
    times = _times(data, dim)
    seconds = _seconds_per(per, times)
    settings: dict[str, Any] = {
        "method": method,
        "threshold": threshold,
        "sigma": sigma,
        "level": level,
        "seed": seed,
        "options": options,
    }
    # A series without values: the arguments are checked now and not when a chunk is computed.
    fit_trend(times, np.full(times.size, np.nan), **settings)
    arrays = [_in_one_chunk(data, dim)]
    if weights is not None:
        _check_weights(weights, dim)
        arrays.append(_in_one_chunk(weights, dim))
    lazy = any(array.chunks is not None for array in arrays)
    columns = xr.apply_ufunc(
        _fit_pixels,
        *arrays,
        input_core_dims=[[dim]] * len(arrays),
        output_core_dims=[[]] * len(_OUTPUTS),
        dask="parallelized",
        output_dtypes=[np.float64] * len(_OUTPUTS),
        # Attributes of the coordinates; those of the variables are written below.
        keep_attrs="override",
        # Chunks are dealt to threads by dask.
        kwargs={"times": times, "seconds": seconds, "threads": 1 if lazy else None, "settings": settings},
    )
    trend = xr.Dataset(dict(zip(_OUTPUTS, columns, strict=True)))
    return _described(trend, data, dim, times, per, method, level)


def _fit_pixels(
    values: np.ndarray[Any, Any],
    weights: np.ndarray[Any, Any] | None = None,
    *,
    times: np.ndarray[Any, Any],
    seconds: float,
    threads: int | None,
    settings: dict[str, Any],
) -> tuple[FloatArray, ...]:
    """Fit along the last axis; one array per output, without that axis."""
    if weights is not None:
        values, weights = np.broadcast_arrays(values, weights)
    shape = values.shape[:-1]
    if values.size == 0:
        return tuple(np.full(shape, np.nan) for _ in _OUTPUTS)
    table = fit_trends(
        times,
        _rows(values),
        weights=None if weights is None else _rows(weights),
        threads=threads,
        points=False,
        **settings,
    )
    slope, intercept = table.parameters["slope"], table.parameters["intercept"]
    columns = (
        slope.value * seconds,
        slope.stderr * seconds,
        slope.low * seconds,
        slope.high * seconds,
        intercept.value,
        table.p_value,
        _where(table.fitted, table.inlier_ratio),
        _where(table.fitted, table.sigma),
    )
    return tuple(column.reshape(shape) for column in columns)


def _rows(array: np.ndarray[Any, Any]) -> FloatArray:
    return np.ascontiguousarray(array, dtype=np.float64).reshape(-1, array.shape[-1])


def _where(fitted: BoolArray, column: FloatArray) -> FloatArray:
    return np.where(fitted, column, np.nan)


def _times(data: xr.DataArray, dim: Hashable) -> np.ndarray[Any, Any]:
    """Take the times along the dimension; refuse what cannot be fitted."""
    if not isinstance(data, xr.DataArray):
        raise InputError("data", f"expected an xarray.DataArray, got {type(data).__name__}")
    if data.dtype.kind not in "iuf":
        raise InputError("data", f"expected numbers, got {data.dtype}")
    if dim not in data.dims:
        known = ", ".join(repr(name) for name in data.dims)
        raise InputError("dim", f"there is no dimension {dim!r}; the dimensions are {known or 'none'}")
    times = np.asarray(data[dim].values)
    if times.dtype.kind == "O":
        raise InputError(
            "dim",
            f"the coordinate {dim!r} holds objects, such as cftime dates, and not datetime64 or numbers; "
            'data.convert_calendar("standard", use_cftime=False) makes datetime64 of cftime dates',
        )
    if times.dtype.kind not in "iufM":
        raise InputError("dim", f"the coordinate {dim!r} holds {times.dtype}, and not datetime64 or numbers")
    return times


def _seconds_per(per: str | None, times: np.ndarray[Any, Any]) -> float:
    if per is None:
        return 1.0
    if times.dtype.kind != "M":
        raise InputError("per", "plain numbers have a unit of their own; leave it out")
    if per not in SECONDS_PER:
        raise InputError("per", f"unknown unit {per!r}; known: {', '.join(SECONDS_PER)}")
    return SECONDS_PER[per]


def _check_weights(weights: xr.DataArray, dim: Hashable) -> None:
    if not isinstance(weights, xr.DataArray):
        raise InputError("weights", f"expected an xarray.DataArray, got {type(weights).__name__}")
    if weights.dtype.kind not in "iuf":
        raise InputError("weights", f"expected numbers, got {weights.dtype}")
    if dim not in weights.dims:
        raise InputError("weights", f"weights need the dimension {dim!r}")


def _in_one_chunk(data: xr.DataArray, dim: Hashable) -> xr.DataArray:
    """Join the chunks along a dimension, which every fit reads whole."""
    if data.chunks is None or len(data.chunksizes[dim]) == 1:
        return data
    # Whole images, one chunk per time, would become one chunk of everything.
    return data.chunk({name: -1 if name == dim else "auto" for name in data.dims})


def _described(
    trend: xr.Dataset,
    data: xr.DataArray,
    dim: Hashable,
    times: np.ndarray[Any, Any],
    per: str | None,
    method: str,
    level: float,
) -> xr.Dataset:
    """Attach the attributes of the data, what each variable is, and its unit."""
    dated = times.dtype.kind == "M"
    kept = {name: value for name, value in data.attrs.items() if name not in _OF_THE_VALUES}
    trend.attrs = kept | {"method": method, "confidence_level": level}
    missing = np.isnat(times) if dated else ~np.isfinite(times.astype(np.float64))
    origin = moment_text(times[~missing].min()) if dated and not missing.all() else "0"
    words = {
        "slope": f"robust trend along {dim}",
        "slope_stderr": "standard error of the slope",
        "slope_low": "lower confidence limit of the slope",
        "slope_high": "upper confidence limit of the slope",
        "intercept": f"value of the trend at {dim} = {origin}",
        "p_value": 'p-value of "the slope is zero"',
        "inlier_ratio": "share of the values that follow the trend",
        "sigma": "noise scale of a value that follows the trend",
    }
    of_values = data.attrs.get("units")
    # Undecoded times say "days since 2000-01-01".
    of_time = (per or "second") if dated else str(data[dim].attrs.get("units", "")).split(" since ")[0]
    for name, text in words.items():
        attributes = {"long_name": text}
        if name in ("p_value", "inlier_ratio"):
            attributes["units"] = "1"
        elif name.startswith("slope"):
            if of_values and of_time:
                attributes["units"] = f"{of_values} per {of_time}"
        elif of_values:
            attributes["units"] = of_values
        trend[name].attrs = attributes
    return trend


__all__ = ["SECONDS_PER", "robust_trend"]
