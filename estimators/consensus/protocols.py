"""The roles of the RANSAC family, with the contract of each in words (DESIGN: the engine; METHODS.md 14).

A method is a row of policies, one per role. Roles see arrays only, never single points in Python. Policies
are frozen dataclasses; those with a ``code`` also exist in compiled code, where the code stands for them.

Invariants of every composition, each a property test:

1. The result is a function of data, settings and seed; batch size and thread count do not enter.
2. The best model never gets worse: optimisation and final fit are accepted only if they are not.
3. A lossless verifier changes evaluation counts and nothing else.
4. Scores see residuals and the order of points only; labelers alone make labels; terminations alone stop.
5. The ledger reproduces the reported sampling probability.
6. y -> c y + e x + f transforms the parameters and leaves the labels, if the threshold is scaled with c.
7. If all minimal samples fit the work budget, they are enumerated and the probability is 1.
"""

from __future__ import annotations

from typing import NamedTuple, Protocol

from estimators.arrays import BoolArray, FloatArray, IntArray
from estimators.consensus.found import Search
from estimators.consensus.optimizers.plan import Plan
from estimators.consensus.samplers.draws import Draws
from estimators.options import RobustOptions

__all__ = [
    "Labeler",
    "Model",
    "Optimizer",
    "Policies",
    "Sampler",
    "Score",
    "Search",
    "Solved",
    "Termination",
    "Verifier",
]


class Solved(NamedTuple):
    """Models of a block of minimal samples.

    Attributes
    ----------
    theta : ndarray of float64, shape (m, p)
        Usable models, in the order of their samples.
    owner : ndarray of int64, shape (m,)
        Sample of each model; a solver with several solutions repeats it.
    degenerate, invalid : int
        Samples refused before solving, models refused after it.
    """

    theta: FloatArray
    owner: IntArray
    degenerate: int
    invalid: int


class Model(Protocol):
    """What is fitted.

    Residuals are signed and *whitened*: divided by the known standard deviation of each point up to a common
    factor, so that one threshold fits all points. ``fit`` returns None where the points leave a parameter
    undetermined; it never raises for numerical reasons. All sums run in a fixed order.
    """

    @property
    def n(self) -> int:
        """Number of points."""
        ...

    @property
    def p(self) -> int:
        """Number of parameters."""
        ...

    @property
    def sample_size(self) -> int:
        """Points of a minimal sample."""
        ...

    @property
    def resolution(self) -> float:
        """Smallest residual that the arithmetic can tell from zero; positive."""
        ...

    def solve(self, samples: IntArray) -> Solved:
        """Models through minimal samples, shape (m, s), each sample ascending."""
        ...

    def residuals(self, theta: FloatArray, start: int, stop: int) -> FloatArray:
        """Residuals, shape (m, stop - start), of models of shape (m, p) at points ``start .. stop - 1``."""
        ...

    def residuals_at(self, theta: FloatArray, points: IntArray) -> FloatArray:
        """Residuals, shape (k,), of one model, shape (p,), at k points; equal to the bit to ``residuals``."""
        ...

    def fit(self, members: IntArray, theta: FloatArray) -> FloatArray | None:
        """Least squares of the whitened residuals of the members, started at ``theta``."""
        ...


class Sampler(Protocol):
    """Where minimal samples come from.

    Sample h is a pure function of (seed, h) and of the ranking of the points; its points are distinct. The
    law of the samples is known exactly, so that :class:`Draws` can say what the draws so far are worth.
    """

    @property
    def code(self) -> int:
        """What :func:`estimators.consensus.samplers.draws.draw_block` knows the sampler by."""
        ...

    def rank(self, quality: FloatArray | None, n: int, seed: int) -> IntArray:
        """Order in which the sampler prefers the points; empty if it has none."""
        ...


class Score(Protocol):
    """What a model is worth: the sum over the points of rho(u), u = (r / T)^2, lower is better.

    rho is 0 at 0, never negative, never decreasing, and constant from u = 1 on (inclusive: r <= T is inside).
    """

    @property
    def code(self) -> int:
        """What :func:`estimators.consensus.scan.score_chunk` knows the score by."""
        ...

    def rho(self, u: FloatArray) -> FloatArray:
        """Evaluate the loss as an equation; compiled code computes the same sums."""
        ...


class Verifier(Protocol):
    """How much of a model's residuals is computed. It never changes the value of a model that survives."""

    @property
    def code(self) -> int:
        """1 if the verifier bails out, else 0."""
        ...

    @property
    def lossless(self) -> bool:
        """Whether the result is the same as with every model valued on every point."""
        ...

    def bound(self, best_loss: float) -> float:
        """Partial loss above which a model is refused, given the best complete loss."""
        ...


class Optimizer(Protocol):
    """Local optimisation of a new best model. It never returns a worse one than it was given."""

    def plan(self, sample_size: int) -> Plan:
        """Describe it as data."""
        ...


class Termination(Protocol):
    """When to stop. It reads the consensus and the law of the draws, never the clock."""

    @property
    def code(self) -> int:
        """What the compiled path knows the termination by."""
        ...

    @property
    def may_enumerate(self) -> bool:
        """Whether enumeration may replace the draws."""
        ...

    def before(self, draws: Draws, options: RobustOptions) -> int:
        """Bound the draws while no model is known."""
        ...

    def after(self, draws: Draws, inlier: BoolArray, options: RobustOptions) -> int:
        """Bound the draws in all, now that the best model has these inliers; 0 stops at once."""
        ...


class Labeler(Protocol):
    """The only maker of labels."""

    def labels(self, residual: FloatArray, threshold: float) -> BoolArray:
        """Inlier flags, shape (n,), of whitened residuals, shape (n,)."""
        ...


class Policies(Protocol):
    """One row: a policy per role, and the number of hypotheses between two looks at the best model."""

    @property
    def sampler(self) -> Sampler: ...  # noqa: D102
    @property
    def score(self) -> Score: ...  # noqa: D102
    @property
    def verifier(self) -> Verifier: ...  # noqa: D102
    @property
    def optimizer(self) -> Optimizer: ...  # noqa: D102
    @property
    def termination(self) -> Termination: ...  # noqa: D102
    @property
    def labeler(self) -> Labeler: ...  # noqa: D102
    @property
    def block(self) -> int: ...  # noqa: D102
