"""Slots of the fixed record that the kernel writes for each series."""

from __future__ import annotations

(
    FOUND,
    LEVEL,
    SLOPE,
    SIGMA,
    THRESHOLD,
    PROPOSED,
    WEIGHED,
    EVALUATIONS,
    RUNNER,
    RUNNER_LEVEL,
    RUNNER_SLOPE,
    RUNNER_SIGMA,
    RUNNER_MARGIN,
    RUNNER_INLIERS,
) = range(14)
RECORD = 14
"""Length of a record. FOUND and RUNNER are flags; a margin is in log evidence."""
