"""What a cleaner says of each fix, as the writers of track files take it: :class:`Cleaned`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType

from estimators.arrays import BoolArray, FloatArray, InputError


@dataclass(frozen=True, slots=True)
class Cleaned:
    """Columns beside a recording's, one value per fix, in its order.

    Parameters
    ----------
    lat, lon : ndarray of float64, shape (n,)
        Cleaned position in degrees; NaN where there is none.
    height_m : ndarray of float64, shape (n,), optional
    inlier : ndarray of bool, shape (n,), optional
    probability : ndarray of float64, shape (n,), optional
        That the fix as recorded is good.
    reason : sequence of str, length n, optional
    others : mapping of str to ndarray of float64, shape (n,)
        What else is written, under its own name, in the order given: ``speed_mps``, ``heading_deg``,
        ``sigma_m``, ... A name that the recording has too takes its place. Names are those of XML elements.

    Raises
    ------
    InputError
        If the columns differ in length.
    """

    lat: FloatArray
    lon: FloatArray
    height_m: FloatArray | None = None
    inlier: BoolArray | None = None
    probability: FloatArray | None = None
    reason: Sequence[str] | None = None
    others: Mapping[str, FloatArray] = field(default_factory=lambda: MappingProxyType({}))

    def __post_init__(self) -> None:
        named = ("lat", "lon", "height_m", "inlier", "probability", "reason")
        columns = {name: getattr(self, name) for name in named} | dict(self.others)
        for name, column in columns.items():
            if column is not None and len(column) != len(self.lat):
                raise InputError(name, f"has {len(column)} rows where lat has {len(self.lat)}")
            if not (name.isascii() and name.isidentifier()):
                raise InputError("others", f"{name[:40]!r} cannot be the name of a column")
