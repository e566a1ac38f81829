"""The facts of an answer as sentences: points, noise, threshold, search, intervals, runner-up, notices.

The chance that a clean sample was drawn is worded as just that: it is not confidence in the fit
(METHODS.md 12).
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING

from estimators.notices import Notice, NoticeCode
from estimators.result import Consensus, Uncertainty
from estimators.trends.evidence import evidence_sentence
from estimators.trends.exponential.domain import noise_sentence
from estimators.trends.presentation.question_words import question_facts
from estimators.trends.presentation.units import percent, significant
from estimators.trends.presentation.wording import WORDS

if TYPE_CHECKING:
    from estimators.trends.trend import RunnerUp, Trend

ADVICE: Mapping[NoticeCode, str] = {
    NoticeCode.few_points: "Add measurements, or give sigma if the noise is known.",
    NoticeCode.no_redundancy: "Add at least one more point to learn how well the line is known.",
    NoticeCode.ambiguous_structure: "Look at the picture; fit a part of the series, or give a threshold.",
    NoticeCode.low_inlier_ratio: "Look at the picture first; give sigma if the noise is known.",
    NoticeCode.low_sampling_probability: "Raise max_hypotheses, or use method auto.",
    NoticeCode.serial_correlation: "Nothing to do; a longer series narrows them, a denser one hardly.",
    NoticeCode.quantised_values: "Send the values with all the digits that the instrument has.",
    NoticeCode.zero_noise: "Check that these are measurements; the intervals say nothing about real noise.",
    NoticeCode.constant_values: "Check that the source still measures.",
    NoticeCode.duplicate_times: "Remove copies of the same reading, if that is what they are.",
    NoticeCode.unsorted_times: "Nothing to do.",
    NoticeCode.missing_values: "Nothing to do, unless there are more than you expect.",
    NoticeCode.invalid_values: "Find out where the infinities come from.",
    NoticeCode.float_nanoseconds: "The digits lost in reading them as floats do not come back.",
    NoticeCode.extrapolation: "Believe them as far as you expect the trend to continue.",
    NoticeCode.not_robust: "Use method auto for an answer that outliers do not move.",
    NoticeCode.earlier_regimes: "Nothing to do; regime='all' fits the whole series.",
    NoticeCode.nonpositive_values: "Give noise='additive' if they are readings like the others.",
    NoticeCode.undetermined_noise: "Give noise if you know it; the two answers differ little where data are.",
    NoticeCode.rate_near_zero: "The series is too short or too noisy to tell growth from decay.",
}
"""What the reader can do about each notice."""

_SIGMA_SOURCES: Mapping[str, str] = {
    "given": "given",
    "mixture": "estimated with the inliers and the outliers together",
    "residuals": "estimated from the residuals",
    "s-estimate": "an S-estimate",
    "floor": "the least that the arithmetic allows",
}


def facts(trend: Trend) -> Iterable[tuple[str, str]]:
    """Yield label and sentence of every fact beside the parameters.

    Parameters
    ----------
    trend : Trend

    Yields
    ------
    tuple of (str, str)
    """
    consensus = trend.consensus
    yield "Points", _points_sentence(consensus, trend.points.inlier.size - consensus.n)
    source = _SIGMA_SOURCES.get(consensus.sigma_source, consensus.sigma_source)
    yield "Noise", f"sigma {significant(consensus.sigma)} ({source})"
    if trend.noise is not None:
        yield "Domain", noise_sentence(trend.noise)
    within = significant(consensus.threshold)
    yield "Threshold", f"an inlier is within {within} of the trend ({_threshold_source(consensus)})"
    quality = [f"R² {significant(trend.r2)}"] if trend.r2 is not None else []
    quality += [f"RMSE {significant(trend.rmse)}"] if trend.rmse is not None else []
    if quality:
        yield "On inliers", ", ".join(quality)
    yield "Intervals", _uncertainty_sentence(trend.uncertainty, consensus)
    yield "Search", _search_sentence(trend, consensus)
    if trend.evidence:
        yield "Model", evidence_sentence(trend.evidence)
    yield from question_facts(trend)
    if trend.runner_up is not None:
        yield "Runner-up", _runner_up_sentence(trend, trend.runner_up)


def notice_lines(notices: Iterable[Notice]) -> Iterable[tuple[str, str]]:
    """Yield what each notice says, with its numbers, and what to do about it.

    Parameters
    ----------
    notices : iterable of Notice

    Yields
    ------
    tuple of (str, str)
    """
    for item in notices:
        detail = ", ".join(
            f"{key.replace('_', ' ')} {significant(value) if isinstance(value, float) else value}"
            for key, value in item.detail.items()
            if isinstance(value, (int, float, str))
        )
        message = f"{item.message.rstrip('.')} ({detail})." if detail else item.message
        yield message, ADVICE.get(item.code, "")


def _points_sentence(consensus: Consensus, left_out: int) -> str:
    share = percent(consensus.inlier_ratio)
    text = f"{consensus.inliers:,} of {consensus.n:,} follow the trend ({share})"
    if not left_out:
        return text
    return f"{text}; {left_out:,} more {'row has' if left_out == 1 else 'rows have'} no part in it"


def _threshold_source(consensus: Consensus) -> str:
    if consensus.threshold_source == "given" or consensus.sigma <= 0.0:
        return consensus.threshold_source
    return f"{significant(consensus.threshold / consensus.sigma, 3)} sigma"


def _uncertainty_sentence(uncertainty: Uncertainty, consensus: Consensus) -> str:
    dof = uncertainty.dof
    if uncertainty.method == "none" or dof is None:
        return "none: the points leave nothing to estimate them from"
    law = "the normal law" if math.isinf(dof) else f"t with {significant(dof)} degrees of freedom"
    text = f"{100 * uncertainty.level:g} %, {uncertainty.method}, {law}"
    if uncertainty.resamples is not None:
        text += f", {uncertainty.resamples} resamples in blocks of {uncertainty.block}"
    if uncertainty.stability is not None:
        text += f" of which {percent(uncertainty.stability)} find the same structure"
    if uncertainty.effective_n is None:
        return text
    worth = significant(uncertainty.effective_n)
    text += f"; {consensus.inliers:,} inliers count as {worth} independent ones"
    return text if uncertainty.lag1 is None else f"{text} (lag-1 correlation {uncertainty.lag1:.2f})"


def _search_sentence(trend: Trend, consensus: Consensus) -> str:
    is_of_pairs = trend.model in ("line", "exponential") and not trend.seasons
    sample = "pair" if is_of_pairs else "sample"
    drawn = consensus.ledger.drawn
    if consensus.search == "closed":
        return "none: the method draws no samples"
    if consensus.search == "certified":
        return "certified: no other model has a better consensus"
    if consensus.search == "exhaustive":
        return f"exhaustive: all {drawn:,} {sample}s were tried"
    text = f"{drawn:,} {sample}s drawn"
    if consensus.sampling_probability is None:
        return text
    # A probability that rounds to 1 as a float is still not certainty: draws can all be unlucky.
    chance = percent(min(consensus.sampling_probability, 1.0 - 1e-9))
    return f"{text}; chance that a clean {sample} was among them: {chance}"


def _runner_up_sentence(trend: Trend, other: RunnerUp) -> str:
    verdict = "nearly as good" if other.equally_good else "clearly weaker"
    return (
        f"{WORDS[trend.model].rival(trend, other)}: {other.inliers:,} points follow it instead, "
        f"sigma {significant(other.sigma)}; {verdict}"
    )
