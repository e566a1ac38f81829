"""The verb :func:`fit_trends`: from many series to a :class:`~estimators.trends.table.TrendTable`.

Series go through compiled code in slices, threads share the slices, and no series knows of another:
neither their number nor the cuts between slices change a byte.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextvars import copy_context
from dataclasses import replace
from inspect import signature
from numbers import Integral
from typing import Any

from estimators.arrays import ArrayLike, InputError
from estimators.consensus.cancellation import Cancelled, cancel_flag
from estimators.options import RobustOptions
from estimators.trends.arguments import check_fraction, check_positive, check_seed
from estimators.trends.batch.columns import Columns
from estimators.trends.batch.slices import cut_slices, fit_slice
from estimators.trends.batch.source import Settings, read_source
from estimators.trends.fit import fit_trend
from estimators.trends.table import TrendTable

_DEFAULTS = RobustOptions()


def fit_trends(
    t: ArrayLike,
    values: ArrayLike,
    offsets: ArrayLike | None = None,
    *,
    model: str = "line",
    method: str = "auto",
    threshold: float | None = None,
    sigma: float | None = None,
    weights: ArrayLike | None = None,
    level: float = 0.95,
    seed: int = 0,
    names: Sequence[str] | None = None,
    threads: int | None = None,
    options: RobustOptions | None = None,
    points: bool = True,
    progress: Callable[[int, int], object] | None = None,
    **further: Any,
) -> TrendTable:
    """Fit robust trends to many series at once.

    Every number equals that of :func:`~estimators.trends.fit.fit_trend` on the series alone, to the bit,
    with any number of threads.

    Parameters
    ----------
    t : array_like, shape (total,) or (n,)
        Times of all series one after the other, of the kinds that ``fit_trend`` takes. With values of shape
        (series, n) it may be the n times that all series share.
    values : array_like, shape (total,) or (series, n)
        NaN and None are missing, infinities are invalid.
    offsets : array_like of int, shape (series + 1,)
        Series k is rows ``offsets[k]:offsets[k + 1]``; not given with values of shape (series, n).
    model, method, threshold, sigma, level, seed, options
        As in ``fit_trend``, for all series.
    weights : array_like of the shape of the values, optional
        Precisions, 1/variance up to scale; 0 leaves a row out.
    names : sequence of str, optional
        One different name per series.
    threads : int, optional
        Default: one per processor core.
    points : bool
        Whether to keep labels, probabilities and residuals per input row (default True; 18 bytes a row).
    progress : callable, optional
        Called as ``progress(done, total)``, in series, from the calling thread; an exception from it ends
        the work.
    **further
        Other arguments of ``fit_trend``, such as ``uncertainty``, but ``predict``. Series are then fitted
        one by one, as they are for other models than the line and for methods that draw no samples.

    Returns
    -------
    TrendTable
        One row per series. A series that cannot be fitted, or that ``fit_trend`` would refuse with an
        exception, has a reason in its row; the others are answered.

    Raises
    ------
    InputError
        If an argument cannot be used; ``field`` names it.
    Cancelled
        If the caller's flag was set (:mod:`estimators.consensus.cancellation`).

    Examples
    --------
    >>> import numpy as np
    >>> t = np.concatenate([np.arange(30.0), np.arange(12.0), [4.0]])
    >>> y = np.concatenate([3.0 + 0.5 * np.arange(30.0), 7.0 - 2.0 * np.arange(12.0), [1.0]])
    >>> y[[4, 5, 17, 36]] += 40.0
    >>> table = fit_trends(t, y, [0, 30, 42, 43])
    >>> table.parameters["slope"].value.round(9), table.reason
    (array([ 0.5, -2. ,  nan]), ('', '', 'too_few_points'))
    """
    threshold = check_positive("threshold", threshold)
    sigma = check_positive("sigma", sigma)
    level = check_fraction("level", level)
    seed = check_seed(seed)
    chosen = _DEFAULTS if options is None else options
    if not isinstance(chosen, RobustOptions):
        raise InputError("options", "expected a RobustOptions")
    count = _check_threads(threads)
    settings = Settings(model, method, threshold, sigma, level, seed, chosen, _check_further(further))
    # A fit of nothing looks at every setting.
    settings.fit([], [])
    if weights is not None:
        # Whether the method takes weights, a line through two points tells.
        replace(settings, model="line", further={}).fit([0.0, 1.0], [0.0, 1.0], [1.0, 1.0])
    source = read_source(t, values, offsets, weights, settings)
    titles = _check_names(names, source.series)
    columns = Columns(source, keep_points=points)
    flag = cancel_flag()
    for done in _fit_slices(columns, count):
        if progress is not None:
            progress(done, source.series)
        if flag[0]:
            raise Cancelled
    return columns.to_table(titles)


def _fit_slices(columns: Columns, threads: int) -> Iterator[int]:
    """Fit all slices, in this thread or in several; tell how many series are done."""
    bounds = cut_slices(columns.source.offsets)
    if threads == 1 or len(bounds) < 2:
        for first, last in bounds:
            fit_slice(columns, first, last)
            yield last
        return
    with ThreadPoolExecutor(min(threads, len(bounds)), "fit-trends") as pool:
        # Each slice runs in a copy of this context: it carries the flag that cancels.
        work = [pool.submit(copy_context().run, fit_slice, columns, a, b) for a, b in bounds]
        try:
            for future, (_, last) in zip(work, bounds, strict=True):
                future.result()
                yield last
        finally:
            pool.shutdown(wait=True, cancel_futures=True)


def _check_further(further: dict[str, Any]) -> dict[str, Any]:
    unknown = further.keys() - signature(fit_trend).parameters.keys() | further.keys() & {"y", "predict"}
    if unknown:
        raise TypeError(f"fit_trends() got an unexpected keyword argument {min(unknown)!r}")
    return further


def _check_threads(threads: int | None) -> int:
    if threads is None:
        return os.cpu_count() or 1
    if isinstance(threads, bool) or not isinstance(threads, Integral) or not 1 <= threads <= 1024:
        raise InputError("threads", "must be an integer from 1 to 1024")
    return int(threads)


def _check_names(names: Sequence[str] | None, series: int) -> tuple[str, ...] | None:
    if names is None:
        return None
    given = tuple(names)
    if len(given) != series:
        raise InputError("names", f"{len(given)} names for {series} series")
    if not all(isinstance(name, str) for name in given):
        raise InputError("names", "expected text")
    if len(set(given)) < series:
        raise InputError("names", "every series needs a name of its own")
    return given
