"""When a search stops: after as many draws as the sampler's law asks for, or at the first acceptable model.

A termination is asked twice: before any model is known, and whenever the best model has changed. The engine
never lets the number of draws grow again (METHODS.md 2.2, ledger rules).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from estimators.arrays import BoolArray
from estimators.consensus.samplers.draws import Draws
from estimators.consensus.stopping import clean_probability, draws_needed, log_miss_per_draw
from estimators.kernels import device
from estimators.options import RobustOptions

ADAPTIVE, FIRST_ACCEPTABLE = 0, 1
"""Codes of the terminations in compiled code."""


def acceptable_inliers(given: int, n: int, s: int) -> int:
    """Consensus that is accepted at once: the given one, else half of the points and at least s + 5.

    Five points beyond the sample make an accidental consensus unlikely, 0.5**5 = 3 % (METHODS.md 2.1).

    Examples
    --------
    >>> acceptable_inliers(0, 9, 2), acceptable_inliers(0, 100, 2), acceptable_inliers(0, 4, 2)
    (7, 50, 4)
    """
    return min(n, given if given > 0 else max(s + 5, (n + 1) // 2))


def draws_between(needed: int, options_minimum: int, options_maximum: int) -> int:
    """Clip a number of draws to the bounds that the options set."""
    return min(options_maximum, max(options_minimum, needed))


acceptable_inliers_compiled = device(acceptable_inliers)
draws_between_compiled = device(draws_between)


@dataclass(frozen=True, slots=True)
class Adaptive:
    """Draw until the wanted confidence is reached for the consensus found so far."""

    code: ClassVar[int] = ADAPTIVE
    may_enumerate: ClassVar[bool] = True

    def before(self, draws: Draws, options: RobustOptions) -> int:
        """Nothing is known yet: the most that the options allow."""
        del draws
        return options.max_hypotheses

    def after(self, draws: Draws, inlier: BoolArray, options: RobustOptions) -> int:
        """Draws for the new best model, from the sampler's exact law."""
        return draws_between(
            draws.needed(inlier, options.confidence), options.min_hypotheses, options.max_hypotheses
        )


@dataclass(frozen=True, slots=True)
class FirstAcceptable:
    """Stop at the first model whose consensus is large enough (Fischler & Bolles 1981; METHODS.md 2.1).

    The number of tries is what would find an acceptable consensus, were there one, with the wanted
    confidence; the largest consensus met is then returned. Enumeration never replaces the draws, since
    stopping early in a fixed order of the samples would favour the first points.
    """

    code: ClassVar[int] = FIRST_ACCEPTABLE
    may_enumerate: ClassVar[bool] = False

    def before(self, draws: Draws, options: RobustOptions) -> int:
        """Count the tries that find a consensus that is just acceptable."""
        n, s = draws.t.size, draws.s
        acceptable = acceptable_inliers(options.acceptable_inliers or 0, n, s)
        log_miss = log_miss_per_draw(clean_probability(acceptable, n, s))
        return draws_between(
            draws_needed(log_miss, options.confidence), options.min_hypotheses, options.max_hypotheses
        )

    def after(self, draws: Draws, inlier: BoolArray, options: RobustOptions) -> int:
        """None once the consensus is acceptable."""
        n, s = draws.t.size, draws.s
        acceptable = acceptable_inliers(options.acceptable_inliers or 0, n, s)
        return 0 if int(inlier.sum()) >= acceptable else self.before(draws, options)
