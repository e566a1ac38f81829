"""Array aliases, the error of a caller's mistake, and the check of a column of numbers."""

from __future__ import annotations

from enum import IntEnum
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

FloatArray: TypeAlias = npt.NDArray[np.float64]
IntArray: TypeAlias = npt.NDArray[np.int64]
BoolArray: TypeAlias = npt.NDArray[np.bool_]
CodeArray: TypeAlias = npt.NDArray[np.uint8]
ArrayLike: TypeAlias = npt.ArrayLike

LARGEST_VALUE = 1e60
"""Values, thresholds and noise scales up to this, and ratios of them down to its inverse, have squares that
64-bit floats hold, also after they were multiplied by times."""

SMALLEST_TIME, LARGEST_TIME = 1e-30, 1e30
"""Plain times are 0 or between these, so that slopes, predictions and their squares stay finite."""


class InputError(ValueError):
    """The caller's data or options cannot be used as they are.

    Parameters
    ----------
    field : str
        The argument that is wrong (``"t"``, ``"y"``, ``"threshold"``, ...).
    message : str
        What is wrong and how to mend it.
    """

    def __init__(self, field: str, message: str) -> None:
        super().__init__(f"{field}: {message}")
        self.field = field
        self.message = message


class Reason(IntEnum):
    """Why a row has the label it has; the names are what callers see."""

    ok = 0
    outlier = 1
    missing = 2
    invalid = 3
    duplicate = 4
    zero_weight = 5
    earlier_regime = 6


def as_vector(values: ArrayLike, field: str) -> FloatArray:
    """One-dimensional float64 array of the caller's numbers; ``None`` becomes NaN.

    Parameters
    ----------
    values : array_like
    field : str
        Name used in errors.

    Returns
    -------
    ndarray of float64, shape (n,)

    Raises
    ------
    InputError
        If the values are not numbers or not one-dimensional.
    """
    array = as_column(values, field)
    if array.dtype == np.bool_:
        raise InputError(field, "expected numbers, got booleans")
    if array.dtype.kind not in "iufO":
        raise InputError(field, f"expected numbers, got {array.dtype}")
    if array.dtype.kind == "O" and any(isinstance(value, (bool, str, bytes)) for value in array):
        raise InputError(field, "expected numbers; booleans and text are not numbers")
    try:
        return np.ascontiguousarray(array, dtype=np.float64)
    except OverflowError as error:
        raise InputError(field, "an integer is too large for a 64-bit float") from error
    except (TypeError, ValueError) as error:
        raise InputError(field, "expected numbers") from error


def as_column(values: ArrayLike, field: str) -> npt.NDArray[Any]:
    """One-dimensional array of whatever the caller sent.

    Parameters
    ----------
    values : array_like
    field : str
        Name used in errors.

    Returns
    -------
    ndarray, shape (n,)

    Raises
    ------
    InputError
        If the values are not one-dimensional.
    """
    try:
        array = np.asarray(values)
    except ValueError as error:
        raise InputError(field, "expected one dimension, got rows of unequal lengths") from error
    if array.ndim != 1:
        raise InputError(field, f"expected one dimension, got shape {array.shape}")
    return array
