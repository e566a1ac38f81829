"""The compiled solver's answers for a table of epochs, as arrays."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import chdtri

from estimators.arrays import BoolArray, FloatArray, IntArray
from estimators.gnss.options import PositionOptions
from estimators.gnss.snapshot.epochs import MOST_CLOCKS, MOST_SATELLITES, NUMBERS, answer_epochs
from estimators.gnss.table import EpochTable

SCALE_SHAPE, SCALE_RATE = 3.0, 0.5
"""Inverse-gamma prior of the squared noise scale; the shape is a multiple of 1/2. Sigmas of the customary
weight models are two to three times too large (METHODS_GNSS: noise of .27 to .40 of them at two stations);
true ones must do as well."""

LIMIT_RISK = 1e-3
_LIMITS = np.concatenate([[0.0], chdtri(np.arange(1, MOST_SATELLITES + 1), LIMIT_RISK)])
_LIMITS.setflags(write=False)


@dataclass(frozen=True, slots=True)
class Solved:
    """Raw answers, one row per epoch or per satellite and epoch.

    Attributes
    ----------
    status : ndarray of int64, shape (epochs,)
        ``SOLVED`` and its neighbours in :mod:`estimators.gnss.snapshot.one_epoch`.
    state : ndarray, shape (epochs, 3 + MOST_CLOCKS)
    excluded, rival : ndarray of bool, shape (rows,)
    fault_probability, weight : ndarray, shape (rows,)
        Weight: what a range counts in the answer, from 0 to 1.
    rival_position_m : ndarray, shape (epochs, 3)
    far_probability, hpl_m, vpl_m, squares, rival_probability, rival_distance_m : ndarray, shape (epochs,)
    weighed : ndarray of int64, shape (epochs,)
        Fault sets weighed.
    exhaustive : ndarray of bool, shape (epochs,)
    """

    status: IntArray
    state: FloatArray
    excluded: BoolArray
    rival: BoolArray
    fault_probability: FloatArray
    weight: FloatArray
    rival_position_m: FloatArray
    far_probability: FloatArray
    hpl_m: FloatArray
    vpl_m: FloatArray
    squares: FloatArray
    rival_probability: FloatArray
    rival_distance_m: FloatArray
    weighed: IntArray
    exhaustive: BoolArray


def solve_epochs(table: EpochTable, options: PositionOptions, excluded: BoolArray | None = None) -> Solved:
    """Solve every epoch of a table on its own.

    Parameters
    ----------
    table : EpochTable
    options : PositionOptions
    excluded : ndarray of bool, shape (rows,), optional
        Satellites to leave out; default: the posterior decides.
    """
    rows, epochs = table.pseudoranges_m.size, len(table)
    given = np.zeros(rows, dtype=np.bool_) if excluded is None else excluded
    left_out, rival = np.zeros(rows, dtype=np.bool_), np.zeros(rows, dtype=np.bool_)
    probability, weight = np.full(rows, np.nan), np.full(rows, np.nan)
    state = np.full((epochs, 3 + MOST_CLOCKS), np.nan)
    rival_position = np.full((epochs, 3), np.nan)
    numbers = np.full((epochs, NUMBERS), np.nan)
    status = np.empty(epochs, dtype=np.int64)
    answer_epochs(
        table.satellites_m,
        table.pseudoranges_m,
        table.sigma_m,
        table.clock,
        table.offsets,
        np.array([len(letters) for letters in table.letters], dtype=np.int64),
        table.rotated,
        given,
        excluded is None,
        options.fault_prior,
        SCALE_SHAPE,
        SCALE_RATE,
        options.alert_m,
        options.integrity_risk,
        _LIMITS,
        left_out,
        rival,
        probability,
        weight,
        state,
        rival_position,
        numbers,
        status,
    )
    return Solved(
        status=status,
        state=state,
        excluded=left_out,
        rival=rival,
        fault_probability=probability,
        weight=weight,
        rival_position_m=rival_position,
        far_probability=numbers[:, 0],
        hpl_m=numbers[:, 1],
        vpl_m=numbers[:, 2],
        squares=numbers[:, 3],
        rival_probability=numbers[:, 4],
        rival_distance_m=numbers[:, 5],
        weighed=np.nan_to_num(numbers[:, 6]).astype(np.int64),
        exhaustive=numbers[:, 7] == 1.0,
    )
