"""Method ``araim``: multiple-hypothesis solution separation with protection levels of its own.

Every fault mode that is not too unlikely has a solution of its own; one that lies farther from the solution
of all satellites than noise moves it accuses its mode. Modes of the fewest satellites are excluded first, the
farthest in units of its threshold, and the others are tested again (Blanch et al. 2012, 2015; equations in
:mod:`estimators.gnss.methods.separation`). Protection levels hold for the sigmas as given.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from estimators.arrays import BoolArray
from estimators.geodesy.ellipsoid import to_geodetic
from estimators.geodesy.local_frame import enu_axes
from estimators.gnss.fix import Integrity
from estimators.gnss.methods.fault_modes import list_fault_modes
from estimators.gnss.methods.protocol import Verdict
from estimators.gnss.methods.separation import Separation, protection_levels, separate
from estimators.gnss.options import PositionOptions
from estimators.gnss.snapshot.problem import Problem
from estimators.result import Ledger


@dataclass(frozen=True, slots=True)
class Araim:
    """Solution separation over satellite and constellation faults."""

    def judge(self, problem: Problem, options: PositionOptions) -> Verdict:
        """Exclude fault modes while one lies too far off; levels are those of what is left."""
        clock = problem.table.clock
        lat, lon, _ = to_geodetic(np.ascontiguousarray(problem.state[:3])).tolist()
        axes = enu_axes(lat, lon)
        present = np.ones(clock.size, dtype=np.bool_)
        level = np.inf, np.inf
        solved = 0
        while True:
            modes = list_fault_modes(
                present,
                clock,
                options.satellite_fault,
                options.constellation_fault,
                options.integrity_risk,
            )
            separation = separate(problem, axes, present, modes, options.nominal_bias_m, options.false_alarm)
            if separation is None:
                break
            solved += separation.modes.probability.size
            accused = _most_accused(separation)
            if accused is None:
                level = protection_levels(separation, options.integrity_risk)
                break
            for system in np.unique(clock[present]):
                members = present & (clock == system)
                if not np.any(members & ~accused):
                    # The last satellite of a constellation sets its clock and moves nothing else.
                    accused[np.argmax(members)] = False
            if not accused.any():
                break
            present &= ~accused
        integrity = Integrity(
            *level, options.integrity_risk, options.satellite_fault, method="solution-separation"
        )
        return Verdict(~present, "closed", Ledger(scored=solved), integrity=integrity)


def _most_accused(separation: Separation) -> BoolArray | None:
    """Satellites of the fault mode to exclude, if one passes its threshold."""
    excess = np.max(separation.distance / separation.threshold, axis=1, initial=0.0)
    failing = np.flatnonzero(excess > 1.0)
    if failing.size == 0:
        return None
    size = separation.modes.faulty[failing].sum(axis=1)
    chosen = failing[np.lexsort((-excess[failing], size))[0]]
    return np.array(separation.modes.faulty[chosen])
