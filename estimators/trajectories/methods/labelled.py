"""What every method of labelling answers."""

from __future__ import annotations

from dataclasses import dataclass

from estimators.arrays import CodeArray, FloatArray
from estimators.trajectories.parameters import TrackParameters


@dataclass(frozen=True, slots=True)
class Labelled:
    """What a method says of the fixes that measure something, in order of time.

    Attributes
    ----------
    labels : ndarray of uint8, shape (m,)
        See :mod:`estimators.trajectories.labelling.modes`.
    probability : ndarray, shape (m,)
        Of each fix to be good.
    parameters : TrackParameters
    """

    labels: CodeArray
    probability: FloatArray
    parameters: TrackParameters
