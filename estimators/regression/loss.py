"""Which loss an estimate minimises: the one fact that inference needs to know about a method.

A sandwich variance is made of psi and psi'; both follow from the kind of the loss, its tuning constant
in noise scales, and the residuals (METHODS.md 12).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from enum import IntEnum

import numpy as np
from scipy.special import ndtr

from estimators.arrays import FloatArray


class LossKind(IntEnum):
    """Shape of the loss; ``rank`` stands for estimates from ranks of residuals, such as Theil-Sen's.

    ``tabulated``: psi(u) = u W(|u|) with W given at |u| = k / CELLS_PER_SIGMA.
    """

    square = 0
    truncated = 1
    huber = 2
    bisquare = 3
    sign = 4
    rank = 5
    tabulated = 6


CELLS_PER_SIGMA = 64
"""Resolution of a tabulated weight function, in cells per noise scale."""


def truncated_jump(c: float) -> float:
    """Share of psi' that a loss truncated at ``c`` noise scales loses to its jumps: see :attr:`Loss.jump`."""
    density = math.exp(-0.5 * c * c) / math.sqrt(2.0 * math.pi)
    return 2.0 * c * density / math.erf(c / math.sqrt(2.0))


@dataclass(frozen=True, slots=True)
class Loss:
    """A loss and its tuning constant.

    Attributes
    ----------
    kind : LossKind
    tuning : float
        Constant in noise scales (threshold over sigma for ``truncated``); ignored by ``square``, ``sign`` and
        ``rank``.
    table : ndarray of float64, shape (m,), or None
        Weight function of a ``tabulated`` loss; 0 beyond its end.
    """

    kind: LossKind
    tuning: float = 0.0
    table: FloatArray | None = field(default=None, compare=False, repr=False)

    @property
    def jump(self) -> float:
        """Share of psi' that a truncated loss loses to its jumps: 2 c phi(c) / (2 Phi(c) - 1), else 0.

        E psi' is then 2 Phi(c) - 1 - 2 c phi(c) over all points (METHODS.md 12, B).
        """
        if self.kind is not LossKind.truncated:
            return 0.0
        return truncated_jump(self.tuning)

    def psi(self, u: FloatArray) -> FloatArray:
        """Influence of standardised residuals ``u``, shape (n,)."""
        c = self.tuning
        if self.kind is LossKind.square:
            return u.copy()
        if self.kind is LossKind.truncated:
            return np.where(np.abs(u) <= c, u, 0.0)
        if self.kind is LossKind.huber:
            return np.clip(u, -c, c)
        if self.kind is LossKind.bisquare:
            return np.where(np.abs(u) <= c, u * (1.0 - (u / c) ** 2) ** 2, 0.0)
        if self.kind is LossKind.rank:
            return 2.0 * ndtr(u) - 1.0
        return np.sign(u)

    def psi_slope(self, u: FloatArray) -> FloatArray:
        """Differentiate psi at ``u``; take the expectation under the normal law where psi jumps.

        For ``truncated`` the jump at the cut contributes -2 c phi(c), spread evenly over the inliers:
        E psi' = 2 Phi(c) - 1 - 2 c phi(c) (METHODS.md 12, B). For ``sign`` it is 2 phi(0). ``rank`` takes
        the normal law for the ranks: psi = 2 Phi(u) - 1, whose variance pi / 3 is that of Wilcoxon scores
        and, at even spacing, of the Theil-Sen slope (Sen 1968).
        """
        c = self.tuning
        if self.kind is LossKind.square:
            return np.ones_like(u)
        if self.kind is LossKind.truncated:
            density = np.exp(-0.5 * c * c) / np.sqrt(2.0 * np.pi)
            inside = _normal_mass(c)
            return np.where(np.abs(u) <= c, 1.0 - 2.0 * c * density / inside, 0.0)
        if self.kind is LossKind.huber:
            return np.where(np.abs(u) <= c, 1.0, 0.0)
        if self.kind is LossKind.bisquare:
            v = (u / c) ** 2
            return np.where(v <= 1.0, (1.0 - v) * (1.0 - 5.0 * v), 0.0)
        if self.kind is LossKind.rank:
            return np.asarray(2.0 * np.exp(-0.5 * u * u) / np.sqrt(2.0 * np.pi), dtype=np.float64)
        return np.full_like(u, 2.0 / np.sqrt(2.0 * np.pi))


def _normal_mass(c: float) -> float:
    """Probability that a standard normal lies within ±c."""
    from scipy.special import erf  # noqa: PLC0415

    return float(erf(c / np.sqrt(2.0)))
