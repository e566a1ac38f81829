"""Numba types of what every kernel along a track takes first: :data:`TRACK`."""

from __future__ import annotations

from numba import types

from estimators.kernels import ro

TRACK = (
    ro(types.float64),
    ro(types.float64, 2),
    ro(types.float64),
    ro(types.float64, 2),
    ro(types.float64),
    types.float64,
    types.float64,
    ro(types.float64),
)
"""Of t, fixes, variance, velocity, velocity_variance, colour, manoeuvre and rates, as
:func:`estimators.trajectories.labelling.beam.label_piece` describes them."""
