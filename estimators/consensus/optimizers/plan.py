"""What a local optimisation does, as data: the form in which the methods enter compiled code."""

from __future__ import annotations

from typing import NamedTuple

from estimators.kernels import device


class Plan(NamedTuple):
    """Steps of one local optimisation.

    Attributes
    ----------
    repetitions : int
        Inner repetitions, each from its own non-minimal sample of the inliers.
    sample : int
        Largest size of that sample.
    limit : int
        Most points of one least-squares step inside a repetition; 0 takes all inliers.
    steps : int
        Least-squares steps per repetition, while the threshold shrinks.
    multiplier : float
        Threshold of the first step over the threshold of the last.
    finish : int
        1 to end with one iterated least squares over all inliers.
    """

    repetitions: int
    sample: int
    limit: int
    steps: int
    multiplier: float
    finish: int


def shrunk_threshold(T: float, multiplier: float, step: int, steps: int) -> float:
    """Threshold of a step: from ``multiplier * T`` down to T at the last one, linearly."""
    if steps < 2:
        return T
    return T * (multiplier - (multiplier - 1.0) * (step / (steps - 1)))


def subset_counter(repetition: int, step: int, steps: int) -> int:
    """First random counter of a step, so that no two subsets of one optimisation share numbers."""
    return (repetition * (steps + 1) + step) << 16


shrunk_threshold_compiled = device(shrunk_threshold)
subset_counter_compiled = device(subset_counter)
