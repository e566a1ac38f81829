"""The fit of a batch: series after series in slices, each a record batch that can be written at once.

Series do not see one another, so a slice is answered as it would be with all the others beside it; slices
bound what is held in memory, and between them a fit can end because nobody waits any more.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from estimators import InputError, RobustOptions, fit_trends
from service.codecs.batch.answer import Answer, to_record_batch
from service.codecs.batch.rows import Batch
from service.codecs.columns import Times
from service.errors import Problem, invalid_value
from service.schemas.options import FitArguments, TrendOptions

#: Rows of a slice, unless a single series has more: enough for several threads to share, a fraction of a
#: second of work.
SLICE_ROWS = 262_144

#: The library's arguments by the names they have on the wire.
WIRE_NAMES = {"t": "time", "values": "value", "weights": "weight"} | {
    name: f"options.{name}" for name in TrendOptions.model_fields
}

Progress = Callable[[int, int], None]


def answer_batch(
    batch: Batch,
    arguments: FitArguments,
    *,
    horizon: Times | None,
    points: bool,
    threads: int | None,
    progress: Progress,
) -> Answer:
    """Answer whose parts are fitted while they are read.

    Parameters
    ----------
    batch : Batch
    arguments : FitArguments
    horizon : ndarray, shape (1,), or None
        Time by which values are to be reached, as those of the batch.
    points : bool
        Whether rows are labelled in the answer.
    threads : int or None
        For the fit; None for one per processor. They change no byte of the answer.
    progress : callable
        Called with the series done and all series, also before the first; what it raises ends the fit.

    Returns
    -------
    Answer
    """
    return Answer(
        model=arguments.model,
        method=arguments.method,
        level=arguments.level,
        seed=arguments.seed,
        form=batch.form,
        has_positions=batch.lat is not None,
        has_points=points,
        parts=_parts(batch, arguments, horizon, points=points, threads=threads, progress=progress),
    )


def _parts(
    batch: Batch,
    arguments: FitArguments,
    horizon: Times | None,
    *,
    points: bool,
    threads: int | None,
    progress: Progress,
) -> Iterator[Any]:
    total = len(batch.names)
    try:
        options = RobustOptions(**arguments.options.model_dump())
    except InputError as error:
        raise _of_argument(error) from error
    for first, last in slices(batch.offsets):
        rows = slice(int(batch.offsets[first]), int(batch.offsets[last]))
        before = first

        def tell(done: int, _of: int, before: int = before) -> None:
            progress(before + done, total)

        progress(first, total)
        try:
            table = fit_trends(
                batch.time[rows],
                batch.value[rows],
                batch.offsets[first : last + 1] - rows.start,
                model=arguments.model,
                method=arguments.method,
                threshold=arguments.threshold,
                sigma=arguments.sigma,
                weights=None if batch.weight is None else batch.weight[rows],
                level=arguments.level,
                seed=arguments.seed,
                threads=threads,
                options=options,
                points=points,
                progress=tell,
                noise=arguments.noise,
                uncertainty=arguments.uncertainty,
                degree=arguments.degree,
                seasonal=arguments.seasonal,
                harmonics=arguments.harmonics,
                regime=arguments.regime,
                reach=arguments.reach,
                horizon=horizon,
            )
        except InputError as error:
            raise _of_argument(error) from error
        yield to_record_batch(batch, first, table, arguments, points=points, with_horizon=horizon is not None)
    progress(total, total)


def _of_argument(error: InputError) -> Problem:
    return invalid_value(WIRE_NAMES.get(error.field, error.field), error.message)


def slices(offsets: np.ndarray[Any, np.dtype[np.int64]]) -> Iterator[tuple[int, int]]:
    """Ranges of series that have about :data:`SLICE_ROWS` rows together.

    Parameters
    ----------
    offsets : ndarray of int64, shape (m + 1,)

    Yields
    ------
    tuple of (int, int)
        First series, and the one after the last.

    Examples
    --------
    >>> list(slices(np.array([0, 100_000, 200_000, 500_000, 500_001])))
    [(0, 2), (2, 3), (3, 4)]
    """
    first, count = 0, offsets.size - 1
    while first < count:
        furthest = int(np.searchsorted(offsets, offsets[first] + SLICE_ROWS, side="right")) - 1
        last = min(count, max(first + 1, furthest))
        yield first, last
        first = last
