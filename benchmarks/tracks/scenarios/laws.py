"""Sampling, noise and offsets that several groups of tracks share; metres, and seconds where they last."""

from __future__ import annotations

from benchmarks.tracks import noises, offsets, samplings

HZ = samplings.every(1.0)
USUAL = noises.normal(4.0)
FAR = offsets.scattered(60.0, 3000.0)
NEAR = offsets.scattered(40.0, 300.0)
STEP = offsets.constant(40.0, 400.0)
WALK = offsets.random_walk(50.0, 300.0, 2.0)
BACK = offsets.returning(150.0, 600.0, 12.0)
