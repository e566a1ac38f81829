"""No local optimisation: the best minimal model goes to the final fit as it is."""

from __future__ import annotations

from dataclasses import dataclass

from estimators.consensus.optimizers.plan import Plan


@dataclass(frozen=True, slots=True)
class NoOptimization:
    """Leave the model alone."""

    def plan(self, sample_size: int) -> Plan:
        """Nothing to do."""
        del sample_size
        return Plan(repetitions=0, sample=0, limit=0, steps=0, multiplier=1.0, finish=0)
