"""The wording of each shape, by the shape's name."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from estimators.trends.bases.words import BasisWords, StraightWords
from estimators.trends.exponential.words import ExponentialWords
from estimators.trends.presentation.words import Words

WORDS: Mapping[str, Words] = MappingProxyType(
    {
        "line": StraightWords(),
        "constant": BasisWords(),
        "linear": BasisWords(),
        "exponential": ExponentialWords(),
    }
)
"""How the trend shapes of :data:`estimators.trends.models.MODELS` are put into words."""
