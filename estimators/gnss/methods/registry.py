"""Every method of fault exclusion is one row: a detector, and the words by which people choose it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from estimators.gnss.methods.araim import Araim
from estimators.gnss.methods.glrt import Glrt
from estimators.gnss.methods.greedy import Greedy
from estimators.gnss.methods.huber import Huber
from estimators.gnss.methods.least_squares import LeastSquares
from estimators.gnss.methods.p_ransac import PRansac
from estimators.gnss.methods.protocol import FaultDetector
from estimators.gnss.methods.raim import Raim
from estimators.gnss.methods.ranco import Ranco


@dataclass(frozen=True, slots=True)
class PositionMethod:
    """A named method.

    Attributes
    ----------
    name : str
        What callers pass as ``method``.
    title, summary, when_to_use, source : str
        For people.
    detector : FaultDetector or None
        None leaves the decision to the posterior over fault sets, which is computed in any case.
    robust : bool
        Whether one faulty satellite cannot move the position far; False for methods for comparison.
    """

    name: str
    title: str
    summary: str
    when_to_use: str
    source: str
    detector: FaultDetector | None = None
    robust: bool = True


_ROWS = (
    PositionMethod(
        "auto",
        "Automatic",
        "Weighs every set of faulty satellites by its posterior probability, leaves out the set whose "
        "position is least likely to be far off, and says so when another leads elsewhere. Of the others, "
        "those that agree less count less.",
        "Always, unless you want one particular method.",
        "Plumbline; exact marginal likelihoods in parity space; weights by Huber 1964, Proposal 2",
    ),
    PositionMethod(
        "p-ransac",
        "P-RANSAC style",
        "Solves every minimal subset of satellites, or a fixed sample of very many, and keeps the satellites "
        "that agree with the subset most others agree with, within its own uncertainty.",
        "To compare with consensus methods; several faults at once, without a model of what a fault is.",
        "Castaldo, Angrisano, Gaglione and Troisi 2014",
        PRansac(),
    ),
    PositionMethod(
        "ranco",
        "RANCO style",
        "Solves the minimal subsets of the best weighted geometry, as many as a bound on simultaneous faults "
        "asks for, and leaves out the satellites outside the threshold of the one with the fewest of them.",
        "If you know how many satellites can fail at once, and want nothing left out when it is more.",
        "Schroth, Rippl, Ene, Blanch, Walter and Enge 2008",
        Ranco(),
    ),
    PositionMethod(
        "glrt",
        "Likelihood ratio over fault sets",
        "Searches all sets of faulty satellites by the closed form of what their exclusion takes off the sum "
        "of squares, and leaves out the smallest set whose rest passes the chi-square test.",
        "If you need a definite answer whatever the ambiguity, at sigmas that are right.",
        "Generalised likelihood ratio test; exact in parity space",
        Glrt(),
    ),
    PositionMethod(
        "raim",
        "RAIM with w-tests",
        "Tests the sum of squares against chi square and leaves out the satellite of the largest significant "
        "w-test, one at a time, while two redundant satellites are left.",
        "For the classical answer to one faulty satellite.",
        "Baarda 1968; Parkinson and Axelrad 1988",
        Raim(),
    ),
    PositionMethod(
        "greedy",
        "Greedy residual",
        "Leaves out the satellite whose exclusion lowers the sum of squares most, until the rest passes the "
        "chi-square test.",
        "For epochs of very many satellites, where speed matters more than the last fault found.",
        "Blanch, Walter and Enge 2015",
        Greedy(),
    ),
    PositionMethod(
        "araim",
        "Solution separation",
        "Compares the solution of all satellites with those that leave out each fault mode, excludes modes "
        "that lie too far off, and gives protection levels at the fault probabilities of the options.",
        "If protection levels have to follow the ARAIM user algorithm.",
        "Blanch, Walter, Enge and others 2012, 2015",
        Araim(),
    ),
    PositionMethod(
        "huber",
        "Huber",
        "Reweighted least squares: ranges that fit badly count less, none is left out.",
        "To compare with other software; a gross fault still moves the position.",
        "Huber 1964",
        Huber(),
        robust=False,
    ),
    PositionMethod(
        "ols",
        "Least squares",
        "Weighted least squares over all satellites; no fault is looked for.",
        "To compare with other software.",
        "Gauss",
        LeastSquares(),
        robust=False,
    ),
)

POSITION_METHODS: Mapping[str, PositionMethod] = MappingProxyType({row.name: row for row in _ROWS})
"""The named methods by name, ``auto`` first."""
