"""What a track is made of: noise, motion, and how often fixes go wrong."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from estimators.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class Rates:
    """How often fixes go wrong.

    Attributes
    ----------
    spike, wide, teleport : float
        Probability of each fix.
    entry, redraw, level : float
        Per second: that a burst begins, that its offset jumps, that the noise changes its level.
    walk : float
        By which the offset of a burst walks, m/sqrt(s).
    growth : float
        The same, of the offset's own size.
    """

    spike: float = 0.02
    wide: float = 0.003
    entry: float = 1e-3
    redraw: float = 1 / 40
    teleport: float = 1e-5
    level: float = 1e-3
    walk: float = 1.0
    growth: float = 0.06

    def as_array(self) -> FloatArray:
        """Give the rates in the order that :mod:`estimators.trajectories.labelling.beam` reads."""
        return np.array(
            [
                self.spike,
                self.wide,
                self.entry,
                self.redraw,
                self.teleport,
                self.level,
                self.walk,
                self.growth,
            ]
        )


@dataclass(frozen=True, slots=True)
class TrackParameters:
    """Noise and motion of a track.

    Attributes
    ----------
    sigma : float
        Standard deviation of white noise per axis: metres, or in units of what the receiver reports.
    colour_m : float
        Standard deviation of coloured noise.
    manoeuvre : float
        Spectral density of the acceleration, m^2/s^3.
    rates : Rates
    """

    sigma: float
    colour_m: float
    manoeuvre: float
    rates: Rates = Rates()

    def with_noise(self, sigma: float, colour_m: float, manoeuvre: float) -> TrackParameters:
        """Other noise and motion, the same rates."""
        return replace(self, sigma=sigma, colour_m=colour_m, manoeuvre=manoeuvre)
