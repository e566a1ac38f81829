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
    stray : float
        Of the rate of bursts: that fixes go astray, on a path of their own, either way of beginning.
    swerve, hurry, calm : float
        Per second: that the velocity jumps, that the track begins to manoeuvre, that it ceases to.
    settle : float
        Per second: that a path that is astray goes on beside the track.
    """

    spike: float = 0.02
    wide: float = 0.003
    entry: float = 1e-3
    redraw: float = 1 / 40
    teleport: float = 1e-6
    level: float = 1e-3
    walk: float = 1.0
    growth: float = 0.06
    stray: float = 0.3
    swerve: float = 1e-3
    hurry: float = 1e-3
    calm: float = 0.1
    settle: float = 0.1

    def as_array(self) -> FloatArray:
        """Give the rates in the order that :mod:`estimators.trajectories.labelling.priors` names."""
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
                self.stray,
                self.swerve,
                self.hurry,
                self.calm,
                self.settle,
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
