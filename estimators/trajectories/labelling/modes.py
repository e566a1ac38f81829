r"""What a fix can be, and how likely each of it makes the place where it lies.

The state of a hypothesis is position p, velocity v and bias b, the same covariance for both axes. A fix
measures p + b:

- ``NOMINAL``: noise of variance R; the bias is an Ornstein-Uhlenbeck process of standard deviation c, the
  coloured noise of every receiver. At a higher *noise level* R is 16 or 256 times as large; levels last. At
  the level ``HURRIED`` the noise is usual and the motion is not: acceleration is ten times as dense or more.
- ``WIDE``: the same with 9 R, for this fix alone.
- ``SPIKE``: anywhere. The fix tells nothing.
- ``ENTRY``: a burst begins: the bias is anything, and fixes go on measuring the motion.
- ``BURST``: it goes on; the bias walks, the faster the larger it is.
- ``REDRAW``: the bias of a burst jumps.
- ``EXIT``: the burst is over; the fix is nominal again.
- ``ADRIFT``: the fixes follow a path of their own that tells nothing of the track
  (:mod:`estimators.trajectories.labelling.astray`): a receiver that is drawn away, or thrown off and creeping
  back.
- ``TELEPORT``: the track itself goes on elsewhere; at the level ``SWERVED``, where it was but elsewhither.

A path that leaves the track and a track that swerves look alike; what follows tells: the one ends where the
track would have been.

Where a fix may be anywhere, the density of its distance r from where it was expected is scale-free,
f(r) = 1 / [pi (r^2 + rho^2) ln(1 + R_m^2 / rho^2)], rho^2 = 9 (R + c^2) + P: no size of a fault is assumed
(METHODS_TRACKS, "A composition that works on synthetic tracks").
"""

from __future__ import annotations

import math

from estimators.kernels import arithmetic

NOMINAL, WIDE, SPIKE, ENTRY, BURST, REDRAW, EXIT, TELEPORT, MISSING, ADRIFT = range(10)
"""Kinds of fixes; ``MISSING`` is a row that measures nothing, known before."""

LEVELS = 3
"""Of the noise."""
HURRIED = LEVELS
"""Level of a label while the track manoeuvres."""
SWERVED = 1
"""Level of a teleport that changes the velocity alone."""
GOES_ON, DRAWN_AWAY, THROWN = range(3)
"""Levels of ``ADRIFT``: the path began before, it leaves the track here, it begins elsewhere."""
LEVEL_STRIDE = 10
"""A label is its kind plus this many times its level."""
LEVEL_FACTOR = 16.0
"""Variance of a noise level over that of the one below."""
RESTLESS, BURSTING, ASTRAY = LEVELS, LEVELS + 1, LEVELS + 2
"""Modes of a hypothesis that manoeuvres, within a burst, and on a path of its own; smaller ones are levels of
noise."""
WIDE_FACTOR = 9.0

COLOUR_TIME_S = 10.0
"""Correlation time of coloured noise."""
LONGEST_S = 3600.0
"""A longer step tells no more: after an hour the track may be anywhere, and squares stay within 64 bits."""
REACH_M = 1e5
"""R_m: a fix anywhere is within so many metres."""
STILL_SPREAD_MPS = 30.0
"""Standard deviation of velocity, per axis, before anything is known of it."""
JUMP_SPREAD_MPS = 10.0
"""By which it changes where a track swerves or is teleported."""
_HURRY_FACTOR, _LEAST_HURRY = 10.0, 1.0
"""Of the density of acceleration while a track manoeuvres; m^2/s^3."""
_SETTLED_S, _STEPS_OF_AGE = 300.0, 50.0
"""Ages at which a stray path ends by one per second more than a young one: seconds, and steps on top."""


@arithmetic
def log_normal(squared: float, variance: float) -> float:
    """Ln density of a place so far (squared) from its mean; two axes of equal variance."""
    return -math.log(2.0 * math.pi * variance) - 0.5 * squared / variance


@arithmetic
def log_anywhere(squared: float, core: float, reach: float) -> float:
    """Ln of the scale-free density f; ``core`` is rho^2, ``reach`` is ln(pi ln(1 + R_m^2 / rho^2))."""
    return -math.log(squared + core) - reach


@arithmetic
def exit_rate(age_s: float) -> float:
    """Rate per second at which a burst of an age ends: the longer it lasts the longer it will, up to 15 s."""
    return max(1.5 / (10.0 + age_s), 1.0 / 15.0)


@arithmetic
def return_rate(age_s: float, step_s: float) -> float:
    """Rate per second at which a stray path ends: like a burst, but none lasts.

    Everything could be such a path but its end, so that without ageing a hypothesis that has got lost would
    live for ever.
    """
    return exit_rate(age_s) + age_s / (_SETTLED_S + _STEPS_OF_AGE * step_s)


@arithmetic
def hurry(manoeuvre: float) -> float:
    """Spectral density of the acceleration while a track manoeuvres."""
    return max(_HURRY_FACTOR * manoeuvre, _LEAST_HURRY)


@arithmetic
def bias_walk(bias_squared: float, colour: float, walk: float, growth: float) -> float:
    """Variance per second by which the bias of a burst walks; ``walk`` in m/sqrt(s), ``growth`` of itself."""
    return walk * walk + growth * growth * bias_squared + 2.0 * colour * colour / COLOUR_TIME_S
