"""Which faults solution separation watches: sets of satellites, and whole constellations."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.special import bdtrc

from estimators.arrays import BoolArray, FloatArray, IntArray
from estimators.gnss.methods.minimal_subsets import all_subsets

_MOST_MODES = 5_000
_UNMONITORED_SHARE = 0.1
"""Share of the integrity risk that faults nobody watches may take."""


@dataclass(frozen=True, slots=True)
class FaultModes:
    """Hypotheses of what is faulty.

    Attributes
    ----------
    faulty : ndarray of bool, shape (m, n)
        The satellites of each; those of the fewest satellites first.
    probability : ndarray, shape (m,)
    unmonitored : float
        Probability of everything else.
    """

    faulty: BoolArray
    probability: FloatArray
    unmonitored: float


def list_fault_modes(
    present: BoolArray, clock: IntArray, satellite_fault: float, constellation_fault: float, risk: float
) -> FaultModes:
    """Enumerate simultaneous satellite faults until the others are unlikely, and constellation faults.

    Parameters
    ----------
    present : ndarray of bool, shape (n,)
        Satellites that still take part.
    clock : ndarray of int64, shape (n,)
        Constellation of each.
    satellite_fault, constellation_fault : float
        Probabilities.
    risk : float
        Integrity risk; the unmonitored faults shall take a tenth of it at most.
    """
    rows = np.flatnonzero(present)
    n = rows.size
    most, count = 1, n
    while most < n and float(bdtrc(most, n, satellite_fault)) > _UNMONITORED_SHARE * risk:
        count += math.comb(n, most + 1)
        if count > _MOST_MODES:
            break
        most += 1
    parts, probability = [], []
    for size in range(1, most + 1):
        sets = rows[all_subsets(n, size)]
        faulty = np.zeros((sets.shape[0], present.size), dtype=np.bool_)
        faulty[np.arange(sets.shape[0])[:, None], sets] = True
        parts.append(faulty)
        probability += [satellite_fault**size] * sets.shape[0]
    systems = np.unique(clock[present])
    unmonitored = float(bdtrc(most, n, satellite_fault)) if most < n else 0.0
    if systems.size > 1:
        parts.append(present & (clock == systems[:, None]))
        probability += [constellation_fault] * systems.size
        unmonitored += float(bdtrc(1, systems.size, constellation_fault))
    return FaultModes(np.concatenate(parts), np.array(probability), unmonitored)
