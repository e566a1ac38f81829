"""The types of tracks, and which of them methods may be tuned on.

``tune`` and ``held_out`` are fixed here. Each group has both, and what is held out differs in kind: another
motion, another family of offsets, another law or correlation time of the noise, a stronger fault; so that a
cleaner that has learnt the first half by heart is found out on the second.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from benchmarks.tracks.generator import Scenario
from benchmarks.tracks.scenarios.faulty import BURSTS, MIXED, SPIKES
from benchmarks.tracks.scenarios.hostile import HARD, OTHER, SPARSE
from benchmarks.tracks.scenarios.sound import CLEAN, COLOURED

SCENARIOS: Mapping[str, Scenario] = MappingProxyType(
    {row.name: row for rows in (CLEAN, SPIKES, BURSTS, MIXED, HARD, COLOURED, SPARSE, OTHER) for row in rows}
)
"""Every type of track by name, by groups."""

GROUPS = tuple(dict.fromkeys(row.group for row in SCENARIOS.values()))
