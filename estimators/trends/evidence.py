"""What speaks for each shape of trend that was weighed against others."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from estimators.trends.presentation.units import significant


@dataclass(frozen=True, slots=True)
class Evidence:
    """A shape of trend that was weighed.

    Attributes
    ----------
    model : str
        Name of the shape; see :func:`estimators.models`.
    degree : int or None
        Of a polynomial.
    coefficients : int
        Numbers that the shape fits.
    log_evidence : float
        Log-likelihood of the values, outliers included, less half a ln n per coefficient (Schwarz 1978), more
        where few points follow the shape, and less ln 20 for each step from a level to a slope and a bend.
    margin : float
        By how much it is less than that of the best shape; 0 for the best.
    sigma : float
        Noise scale under it, in units of the values; of their logarithm where noise is multiplicative.
    inliers : int
    chosen : bool
    """

    model: str
    degree: int | None
    coefficients: int
    log_evidence: float
    margin: float
    sigma: float
    inliers: int
    chosen: bool


def evidence_sentence(evidence: Sequence[Evidence]) -> str:
    """Say which shape the values speak for, and by how much.

    Parameters
    ----------
    evidence : sequence of Evidence
        The best first.

    Examples
    --------
    >>> rows = [Evidence("line", None, 2, 90.0, 0.0, 1.0, 50, True)]
    >>> rows += [Evidence("linear", 2, 3, 88.0, 2.0, 1.0, 50, False)]
    >>> evidence_sentence(rows)
    'line, told from the data; in log evidence behind it: linear of degree 2 by 2'
    """
    best, *others = evidence
    text = f"{_name(best)}, told from the data"
    if not others:
        return f"{text}; no other shape could be fitted"
    behind = ", ".join(f"{_name(row)} by {significant(row.margin, 3)}" for row in others)
    return f"{text}; in log evidence behind it: {behind}"


def _name(row: Evidence) -> str:
    return row.model if row.degree is None else f"{row.model} of degree {row.degree}"
