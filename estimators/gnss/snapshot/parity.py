"""What a least-squares solution leaves over: the matrices by which fault sets are judged without re-solving.

With the whitened design A and residuals z, N = (A'A)^-1 and S = I - A N A'. Without the satellites F the sum
of squares is SSE - z_F' S_FF^-1 z_F and the solution moves by -N A_F' S_FF^-1 z_F (both exact for the
linearised model; METHODS_GNSS, "Identities worth having").
"""

from __future__ import annotations

from estimators.arrays import FloatArray
from estimators.kernels import device


@device
def fill_inverse(factor: FloatArray, inverse: FloatArray) -> None:
    """Inverse of the matrix whose Cholesky factor is given."""
    p = factor.shape[0]
    for column in range(p):
        for j in range(p):
            held = 1.0 if j == column else 0.0
            for k in range(j):
                held -= factor[j, k] * inverse[k, column]
            inverse[j, column] = held / factor[j, j]
        for j in range(p - 1, -1, -1):
            held = inverse[j, column]
            for k in range(j + 1, p):
                held -= factor[k, j] * inverse[k, column]
            inverse[j, column] = held / factor[j, j]


@device
def fill_parity(A: FloatArray, N: FloatArray, gain: FloatArray, S: FloatArray) -> None:
    """Write the gain N A', shape (p, n), and S = I - A N A', shape (n, n)."""
    n, p = A.shape
    for j in range(p):
        for i in range(n):
            held = 0.0
            for k in range(p):
                held += N[j, k] * A[i, k]
            gain[j, i] = held
    for i in range(n):
        for j in range(i + 1):
            held = 1.0 if i == j else 0.0
            for k in range(p):
                held -= A[i, k] * gain[k, j]
            S[i, j] = held
            S[j, i] = held
