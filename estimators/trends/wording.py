"""The wording of each shape, by the shape's name."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from estimators.trends.line_words import LineWords
from estimators.trends.words import Words

WORDS: Mapping[str, Words] = MappingProxyType({"line": LineWords()})
"""How the trend shapes of :data:`estimators.trends.models.MODELS` are put into words."""
