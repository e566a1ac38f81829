"""What a method of fault exclusion is: from an epoch at its least-squares solution to a verdict."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from estimators.arrays import BoolArray, FloatArray
from estimators.gnss.fix import Integrity
from estimators.gnss.options import PositionOptions
from estimators.gnss.snapshot.problem import Problem
from estimators.result import Ledger, SearchKind


@dataclass(frozen=True, slots=True)
class Verdict:
    """Which satellites a method leaves out.

    Attributes
    ----------
    excluded : ndarray of bool, shape (n,)
    search : {"sampled", "exhaustive", "certified", "closed"}
    ledger : Ledger
    inflation : ndarray of float64, shape (n,), or None
        Factors, at least 1, on the sigmas in the final solution, of methods that weigh instead of excluding.
    integrity : Integrity or None
        Protection levels of the method's own; default those of the posterior.
    """

    excluded: BoolArray
    search: SearchKind
    ledger: Ledger = Ledger()  # noqa: RUF009  # frozen
    inflation: FloatArray | None = None
    integrity: Integrity | None = None


class FaultDetector(Protocol):
    """A method of fault exclusion; stateless, and a pure function of the epoch.

    It must not depend on the order of the satellites, nor on a clock error common to a system.
    """

    def judge(self, problem: Problem, options: PositionOptions) -> Verdict:
        """Say which satellites to leave out.

        Parameters
        ----------
        problem : Problem
            Linearised near the answer; ``z``, ``N``, ``gain`` and ``S`` are those of all satellites.
        options : PositionOptions
        """
        ...
