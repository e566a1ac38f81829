"""robust_trend: every pixel as fit_trend answers it, eager or lazy, whatever the chunks."""

from __future__ import annotations

from typing import Any

import dask
import dask.array
import numpy as np
import pandas as pd
import pytest
import xarray as xr

from estimators import InputError, fit_trend
from estimators.adapters.xarray import SECONDS_PER, robust_trend

MONTHS = pd.date_range("1990-01-01", periods=60, freq="MS")
NAMES = ("slope", "slope_stderr", "slope_low", "slope_high", "intercept", "p_value", "inlier_ratio", "sigma")


def made(times: Any = MONTHS, *, missing: bool = True) -> xr.DataArray:
    """5 x 4 pixels over time, in kelvin: slopes that grow with x, outliers, gaps and an empty pixel."""
    random = np.random.default_rng(0)
    step = np.arange(len(times))
    values = 280.0 + step[:, None, None] * (0.02 * np.arange(4)) + 0.1 * random.standard_normal((60, 5, 4))
    values[random.uniform(size=values.shape) < 0.2] += 15.0
    if missing:
        values[random.uniform(size=values.shape) < 0.05] = np.nan
        values[:, 2, 3] = np.nan
        values[1:, 4, 0] = np.nan
    return xr.DataArray(
        values,
        dims=("time", "y", "x"),
        coords={
            "time": times,
            "y": np.arange(5) * 10.0,
            "x": ("x", np.arange(4) * 5.0, {"units": "m"}),
            "land": (("y", "x"), np.ones((5, 4), bool)),
        },
        name="surface",
        attrs={
            "units": "K",
            "long_name": "temperature",
            "standard_name": "air_temperature",
            "source": "made",
        },
    )


def expected(data: xr.DataArray, y: int, x: int, **arguments: Any) -> list[float]:
    """The numbers of one pixel by fit_trend."""
    trend = fit_trend(data.time.values, data.values[:, y, x], **arguments)
    if not trend:
        return [np.nan] * len(NAMES)
    slope, intercept = trend.parameters["slope"], trend.parameters["intercept"]
    numbers = [
        *(slope.value, slope.stderr, slope.low, slope.high, intercept.value, trend.p_value),
        *(trend.consensus.inlier_ratio, trend.consensus.sigma),
    ]
    return [np.nan if number is None else number for number in numbers]


def assert_identical(one: xr.Dataset, other: xr.Dataset) -> None:
    """Equal to the bit, with coordinates and attributes."""
    xr.testing.assert_identical(one, other)
    assert {name: one[name].values.tobytes() for name in NAMES} == {
        name: other[name].values.tobytes() for name in NAMES
    }


@pytest.mark.parametrize("arguments", [{}, {"method": "msac", "seed": 3, "level": 0.9}, {"threshold": 0.5}])
def test_every_pixel_is_what_fit_trend_answers_to_the_bit(arguments: dict[str, Any]) -> None:
    data = made()
    trend = robust_trend(data, **arguments)
    for y in range(5):
        for x in range(4):
            found = np.array([trend[name].values[y, x] for name in NAMES])
            np.testing.assert_array_equal(found, expected(data, y, x, **arguments))


@pytest.mark.parametrize("chunks", [{"y": 2, "x": 3}, {"x": 1}, {}, {"time": 7, "y": 5}, {"time": 1}])
def test_lazy_is_eager_to_the_bit_whatever_the_chunks(chunks: dict[str, int]) -> None:
    data = made()
    assert_identical(robust_trend(data.chunk(chunks)).compute(scheduler="threads"), robust_trend(data))


def test_nothing_is_computed_before_it_is_asked_for() -> None:
    def refuse(block: Any) -> Any:
        raise AssertionError(f"a block was computed: {block.shape}")

    data = made(missing=False)
    blocks = dask.array.from_array(data.values, chunks=(60, 2, 2)).map_blocks(
        refuse, dtype=float, meta=np.empty((0, 0, 0))
    )
    trend = robust_trend(data.copy(data=blocks))
    assert trend.slope.chunks == ((2, 2, 1), (2, 2))
    assert {str(trend[name].dtype) for name in NAMES} == {"float64"}
    with pytest.raises(AssertionError, match="a block was computed"):
        trend.slope.compute()


def test_chunks_along_time_are_joined_without_making_one_chunk_of_everything() -> None:
    images = made().chunk({"time": 1})
    with dask.config.set({"array.chunk-size": "2KiB"}):
        trend = robust_trend(images)
    assert len(trend.slope.chunks[0]) > 1 or len(trend.slope.chunks[1]) > 1
    assert_identical(trend.compute(), robust_trend(made()))


def test_the_whole_answer_is_computed_in_one_pass_over_the_pixels() -> None:
    data = made(missing=False)
    passes = []

    def count(block: Any) -> Any:
        passes.append(1)
        return block

    blocks = dask.array.from_array(data.values, chunks=(60, 5, 2)).map_blocks(
        count, dtype=float, meta=np.empty((0, 0, 0))
    )
    robust_trend(data.copy(data=blocks)).compute()
    assert len(passes) == 2


def test_a_pixel_without_a_trend_is_nan_in_every_variable() -> None:
    trend = robust_trend(made())
    for y, x in ((2, 3), (4, 0)):
        assert all(np.isnan(trend[name].values[y, x]) for name in NAMES)
    assert np.isfinite(trend.slope.values).sum() == 18


def test_integers_and_single_precision_are_taken() -> None:
    data = made(missing=False)
    for dtype in ("int16", "float32"):
        narrow = (data * 10).astype(dtype)
        assert_identical(robust_trend(narrow), robust_trend(narrow.astype(float)))


def test_the_dimension_may_stand_anywhere() -> None:
    data = made()
    assert_identical(robust_trend(data.transpose("y", "x", "time")), robust_trend(data))
    assert_identical(robust_trend(data.transpose("x", "time", "y")).transpose("y", "x"), robust_trend(data))


def test_one_series_gives_numbers_without_dimensions() -> None:
    data = made()
    trend = robust_trend(data[:, 1, 2])
    assert dict(trend.sizes) == {}
    np.testing.assert_array_equal([trend[name].item() for name in NAMES], expected(data, 1, 2))


def test_a_dimension_of_another_name_is_taken() -> None:
    data = made().rename(time="month")
    np.testing.assert_array_equal(robust_trend(data, "month").slope, robust_trend(made()).slope)


def test_coordinates_of_the_pixels_are_kept() -> None:
    trend = robust_trend(made())
    assert set(trend.coords) == {"x", "y", "land"}
    assert trend.x.attrs == {"units": "m"}


def test_no_pixels_give_no_trends() -> None:
    assert robust_trend(made()[:, :0]).slope.shape == (0, 4)


def test_no_times_give_nan() -> None:
    assert np.isnan(robust_trend(made()[:0]).slope.values).all()


@pytest.mark.parametrize("per", SECONDS_PER)
def test_the_slope_is_stated_per_unit_of_time(per: str) -> None:
    data = made()
    second, wanted = robust_trend(data), robust_trend(data, per=per)
    for name in ("slope", "slope_stderr", "slope_low", "slope_high"):
        np.testing.assert_array_equal(wanted[name], second[name] * SECONDS_PER[per])
        assert wanted[name].attrs["units"] == f"K per {per}"
    for name in ("intercept", "p_value", "sigma"):
        np.testing.assert_array_equal(wanted[name], second[name])


def test_variables_say_what_they_are_and_in_what_unit() -> None:
    trend = robust_trend(made())
    assert {name: trend[name].attrs["units"] for name in NAMES} == {
        **dict.fromkeys(["slope", "slope_stderr", "slope_low", "slope_high"], "K per second"),
        **dict.fromkeys(["intercept", "sigma"], "K"),
        **dict.fromkeys(["p_value", "inlier_ratio"], "1"),
    }
    assert trend.intercept.attrs["long_name"] == "value of the trend at time = 1990-01-01"
    assert trend.attrs == {"source": "made", "method": "auto", "confidence_level": 0.95}


def test_without_a_unit_of_the_values_none_is_made_up() -> None:
    data = made()
    del data.attrs["units"]
    assert "units" not in robust_trend(data).slope.attrs


def test_plain_times_give_the_slope_in_their_own_unit() -> None:
    data = made(xr.Variable("time", np.arange(60) / 12, {"units": "years since 1990-01-01"}))
    trend = robust_trend(data)
    assert trend.slope.attrs["units"] == "K per years"
    np.testing.assert_array_equal([trend[name].values[1, 2] for name in NAMES], expected(data, 1, 2))


def test_without_a_coordinate_the_times_count_from_zero() -> None:
    data = made().drop_vars("time")
    counted = data.assign_coords(time=np.arange(60))
    np.testing.assert_array_equal(robust_trend(data).slope, robust_trend(counted).slope)


@pytest.mark.parametrize("chunked", [False, True])
def test_weights_along_time_or_per_pixel_are_those_of_fit_trend(chunked: bool) -> None:
    data = made()
    random = np.random.default_rng(5)
    along = xr.DataArray(random.uniform(0.5, 2.0, 60), dims="time", coords={"time": MONTHS})
    each = data.copy(data=random.uniform(0.5, 2.0, data.shape))
    for weights in (along, each):
        trend = robust_trend(data.chunk({"y": 2}) if chunked else data, weights=weights).compute()
        full = weights.broadcast_like(data).transpose("time", "y", "x").values
        found = [trend[name].values[1, 2] for name in NAMES]
        np.testing.assert_array_equal(found, expected(data, 1, 2, weights=full[:, 1, 2]))


def test_weights_at_other_times_are_refused() -> None:
    weights = xr.DataArray(np.ones(60), dims="time", coords={"time": MONTHS + pd.Timedelta(days=1)})
    with pytest.raises(ValueError, match="time"):
        robust_trend(made(), weights=weights)


def test_cftime_dates_are_refused_with_the_way_out() -> None:
    dates = xr.date_range("1990-01-01", periods=60, freq="MS", calendar="standard", use_cftime=True)
    data = made(dates)
    with pytest.raises(InputError, match="convert_calendar") as caught:
        robust_trend(data)
    assert caught.value.field == "dim"
    mended = data.convert_calendar("standard", use_cftime=False)
    np.testing.assert_array_equal(robust_trend(mended).slope, robust_trend(made()).slope)


@pytest.mark.parametrize(
    ("change", "field", "words"),
    [
        ({"data": made().values}, "data", "expected an xarray.DataArray, got ndarray"),
        ({"data": made().to_dataset(name="a")}, "data", "expected an xarray.DataArray, got Dataset"),
        ({"data": made() > 280}, "data", "expected numbers, got bool"),
        ({"dim": "t"}, "dim", "the dimensions are 'time', 'y', 'x'"),
        ({"data": made(MONTHS - MONTHS[0])}, "dim", "holds timedelta64"),
        ({"method": "ransack"}, "method", "did you mean 'ransac'"),
        ({"level": 2.0}, "level", "between 0 and 1"),
        ({"threshold": 0.0}, "threshold", "must lie"),
        ({"per": "fortnight"}, "per", "known: second, minute, hour, day, year"),
        ({"data": made(np.arange(60)), "per": "day"}, "per", "plain numbers"),
        ({"weights": np.ones(60)}, "weights", "expected an xarray.DataArray"),
        ({"weights": xr.DataArray(np.ones(5), dims="y")}, "weights", "need the dimension 'time'"),
        ({"weights": xr.DataArray(["a"] * 60, dims="time")}, "weights", "expected numbers"),
    ],
)
@pytest.mark.parametrize("chunked", [False, True])
def test_arguments_that_cannot_be_used_are_refused_at_once(
    change: dict[str, Any], field: str, words: str, chunked: bool
) -> None:
    arguments = {"data": made()} | change
    if chunked and isinstance(arguments["data"], xr.DataArray):
        arguments["data"] = arguments["data"].chunk({"y": 1})
    with pytest.raises(InputError, match=words) as caught:
        robust_trend(**arguments)
    assert caught.value.field == field
