"""A slice of fitted series as an Arrow record batch: the one form from which every format is written.

One row per series. Numbers that a series does not have are null. With points, the rows of a series stand in
lists beside it, in the order of the table they came in.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import pyarrow as pa

import estimators
from estimators.arrays import Reason
from estimators.trends.bases.periods import MOST_FOUND
from service.codecs.batch.cells_out import number_array, time_array
from service.codecs.batch.questions import crossing_columns, regime_columns
from service.codecs.batch.rows import Batch
from service.codecs.columns import TimeForm
from service.schemas.options import FitArguments

if TYPE_CHECKING:
    from estimators import TrendTable

#: Figures of a series in the order of the columns.
FIGURES = ("inlier_ratio", "threshold", "sigma", "p_value", "r2", "rmse", "effective_n", "lag1", "dof")

POINT_PREFIX = "point_"

#: Parts of an estimate, and what the column of each adds to the parameter's name.
_PARTS = {"value": "", "stderr": "_stderr", "low": "_low", "high": "_high"}

_REASONS = pa.array([member.name for member in Reason])


@dataclass(frozen=True, slots=True)
class Answer:
    """What a writer writes.

    Attributes
    ----------
    model, method : str
    level : float
    seed : int
    form : TimeForm
        How times are written.
    has_positions : bool
    has_points : bool
    parts : iterator of pyarrow.RecordBatch
        All of one schema; made while they are written.
    """

    model: str
    method: str
    level: float
    seed: int
    form: TimeForm
    has_positions: bool
    has_points: bool
    parts: Iterator[Any]

    @property
    def time_unit(self) -> str | None:
        """Unit of time of the parameters; None for plain numbers."""
        return None if self.form.kind == "number" else "second"


def parameters_of(arguments: FitArguments) -> tuple[str, ...]:
    """Names of the parameters that a series may have, those that no series of a slice has among them.

    The columns of an answer are settled before its first slice is fitted; where the shape is told from the
    data they are the parameters of all shapes, null for those that a series' shape does not have.

    Examples
    --------
    >>> parameters_of(FitArguments(model="exponential"))
    ('rate', 'level')
    >>> parameters_of(FitArguments(model="constant", seasonal=["year"]))
    ('level', 'season_1_amplitude', 'season_1_peak')
    """
    known = estimators.models()
    of_all = dict.fromkeys(name for row in known.values() for name in row.parameters)
    names = list(known[arguments.model].parameters or of_all)
    names += [f"power_{power}" for power in range(3, (arguments.degree or 1) + 1)]
    seasonal = arguments.seasonal
    seasons = 0 if seasonal is None else MOST_FOUND if seasonal == "auto" else len(seasonal)
    for season in range(1, seasons + 1):
        names += [f"season_{season}_amplitude", f"season_{season}_peak"]
    return tuple(names)


def to_record_batch(
    batch: Batch, first: int, table: TrendTable, arguments: FitArguments, *, points: bool, with_horizon: bool
) -> Any:
    """Record batch of some series of a batch.

    Parameters
    ----------
    batch : Batch
    first : int
        Place of the first of these series.
    table : TrendTable
        Fits of the series from there on.
    arguments : FitArguments
    points : bool
    with_horizon : bool
        Whether the values to reach are wanted by some time.

    Returns
    -------
    pyarrow.RecordBatch
    """
    last = first + len(table)
    names = batch.names[first:last]
    columns: dict[str, Any] = {
        "series": pa.array(names, pa.int64() if isinstance(names[0], int) else pa.string()),
        "fitted": pa.array(table.fitted),
        "reason": _texts(table.reason),
        "message": _texts(table.message),
        "model": _texts(table.models),
    }
    if arguments.model in ("exponential", "auto"):
        columns["noise"] = _texts(table.noise)
    for name in parameters_of(arguments):
        estimates = table.parameters.get(name)
        for part, title in _PARTS.items():
            found = np.full(len(table), np.nan) if estimates is None else getattr(estimates, part)
            columns[name + title] = number_array(found)
    columns["origin"] = time_array(np.asarray(table.origin), batch.form, whole=batch.whole)
    columns["n"] = pa.array(np.asarray(table.n, dtype=np.int64))
    columns["inliers"] = pa.array(np.asarray(table.inliers, dtype=np.int64))
    columns |= {name: number_array(getattr(table, name)) for name in FIGURES}
    if arguments.regime == "last":
        columns |= regime_columns(table, batch.form)
    columns |= crossing_columns(table, arguments, batch.form, with_horizon=with_horizon)
    columns["notices"] = pa.array([list(codes) for codes in table.notices], pa.list_(pa.string()))
    if batch.lat is not None and batch.lon is not None:
        columns["lat"] = number_array(batch.lat[first:last])
        columns["lon"] = number_array(batch.lon[first:last])
    if points:
        columns |= _points(batch, first, table)
    return pa.RecordBatch.from_pydict(columns)


def _points(batch: Batch, first: int, table: TrendTable) -> dict[str, Any]:
    offsets = batch.offsets[first : first + len(table) + 1]
    rows = slice(int(offsets[0]), int(offsets[-1]))
    starts = pa.array((offsets - offsets[0]).astype(np.int32))
    row = np.arange(rows.start, rows.stop) if batch.row is None else batch.row[rows]
    labels = table.points
    flat = {
        "row": pa.array(row),
        "time": time_array(batch.time[rows], batch.form, whole=batch.whole),
        "inlier": pa.array(labels.inlier),
        "probability": number_array(labels.probability),
        "residual": number_array(labels.residual),
        "reason": _REASONS.take(pa.array(labels.reason_codes)),
    }
    return {
        f"{POINT_PREFIX}{name}": pa.ListArray.from_arrays(starts, column) for name, column in flat.items()
    }


def _texts(items: tuple[str, ...]) -> Any:
    return pa.array([item or None for item in items], pa.string())
