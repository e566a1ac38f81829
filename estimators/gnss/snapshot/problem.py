"""One epoch at its least-squares solution: what every method of fault exclusion works on."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import types

from estimators.arrays import BoolArray, FloatArray, IntArray
from estimators.gnss.snapshot.linearise import factorise, fill_normal, iterate, linearise
from estimators.gnss.snapshot.parity import fill_inverse, fill_parity
from estimators.gnss.table import EpochTable
from estimators.kernels import kernel, ro


@dataclass(frozen=True, slots=True)
class Problem:
    """Linearised epoch about a position; all in the units that whitening leaves.

    Attributes
    ----------
    table : EpochTable
        Of one epoch.
    state : ndarray, shape (p,)
        Position (Cartesian) and clocks in metres.
    A : ndarray, shape (n, p)
        Whitened design.
    z : ndarray, shape (n,)
        Whitened residuals at the state.
    N : ndarray, shape (p, p)
        (A'A)^-1 over the rows used: the covariance of the state at unit noise scale.
    gain : ndarray, shape (p, n)
        N A'.
    S : ndarray, shape (n, n)
        I - A N A'.
    used : ndarray of bool, shape (n,)
        Rows of the solution.
    """

    table: EpochTable
    state: FloatArray
    A: FloatArray
    z: FloatArray
    N: FloatArray
    gain: FloatArray
    S: FloatArray
    used: BoolArray

    @property
    def freedom(self) -> int:
        """Redundant satellites of the solution."""
        return int(self.used.sum()) - self.state.size

    @property
    def left_over(self) -> FloatArray:
        """Whitened residuals of least squares over the rows used, whatever position the state is."""
        return np.asarray(self.z - self.A @ (self.gain[:, self.used] @ self.z[self.used]))

    @property
    def squares(self) -> float:
        """Least sum of squared whitened residuals over the rows used."""
        left = self.left_over[self.used]
        return float(left @ left)


def solve_problem(table: EpochTable, used: BoolArray | None = None) -> Problem | None:
    """Least squares over the used satellites of an epoch, from the Earth's centre.

    Parameters
    ----------
    table : EpochTable
        Of one epoch.
    used : ndarray of bool, shape (n,), optional
        Default all.

    Returns
    -------
    Problem or None
        None where the satellites do not determine the position and the clocks.
    """
    n, p = table.pseudoranges_m.size, 3 + len(table.letters[0])
    rows = np.ones(n, dtype=np.bool_) if used is None else np.ascontiguousarray(used)
    if int(rows.sum()) < p:
        return None
    return _linearised(table, np.zeros(p), rows, settled=False)


def problem_at(table: EpochTable, state: FloatArray, used: BoolArray) -> Problem | None:
    """Linearise about a state that lies close enough to the solution.

    Parameters
    ----------
    table : EpochTable
        Of one epoch.
    state : ndarray, shape (p,)
    used : ndarray of bool, shape (n,)
    """
    return _linearised(table, state, used, settled=True)


def _linearised(table: EpochTable, state: FloatArray, used: BoolArray, *, settled: bool) -> Problem | None:
    n, p = table.pseudoranges_m.size, state.size
    A, z = np.empty((n, p)), np.empty(n)
    N, gain, S = np.empty((p, p)), np.empty((p, n)), np.empty((n, n))
    determined = _fill(
        table.satellites_m,
        table.pseudoranges_m,
        table.sigma_m,
        table.clock,
        table.rotated,
        used,
        settled,
        state,
        A,
        z,
        N,
        gain,
        S,
    )
    return Problem(table, state, A, z, N, gain, S, used) if determined else None


@kernel(
    types.boolean(
        ro(types.float64, 2),
        ro(types.float64),
        ro(types.float64),
        ro(types.int64),
        types.boolean,
        ro(types.boolean),
        types.boolean,
        types.float64[::1],
        types.float64[:, ::1],
        types.float64[::1],
        types.float64[:, ::1],
        types.float64[:, ::1],
        types.float64[:, ::1],
    )
)
def _fill(
    satellites: FloatArray,
    ranges: FloatArray,
    sigma: FloatArray,
    clock: IntArray,
    rotated: bool,
    used: BoolArray,
    settled: bool,
    state: FloatArray,
    A: FloatArray,
    z: FloatArray,
    N: FloatArray,
    gain: FloatArray,
    S: FloatArray,
) -> bool:
    """Linearise about a state, where it is a solution already, or about that which iteration finds."""
    p = state.size
    factor, step = np.empty((p, p)), np.empty(p)
    if settled:
        linearise(satellites, ranges, sigma, clock, rotated, state, A, z)
        fill_normal(A, z, used, factor, step)
        if not factorise(factor):
            return False
    elif not iterate(satellites, ranges, sigma, clock, rotated, used, state, A, z, factor, step):
        return False
    fill_inverse(factor, N)
    fill_parity(A, N, gain, S)
    return True
