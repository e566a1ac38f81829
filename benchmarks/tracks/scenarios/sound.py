"""Tracks without faults, and tracks whose noise lasts."""

from __future__ import annotations

from benchmarks.tracks import motions, noises, offsets, samplings
from benchmarks.tracks.faults import Bursts, Spikes
from benchmarks.tracks.generator import Scenario

_HZ = samplings.every(1.0)
_USUAL = noises.normal(4.0)
_FAR = offsets.scattered(60.0, 3000.0)
_STEP = offsets.constant(40.0, 400.0)

# Held out: motions whose speed or velocity is unlike the tuned ones, and the coarser rounding.
CLEAN = (
    Scenario("walk, clean", "clean", "tune", motions.walk, _USUAL, _HZ),
    Scenario("city, clean", "clean", "tune", motions.city, _USUAL, _HZ),
    Scenario("constant velocity, clean", "clean", "tune", motions.constant_velocity, _USUAL, _HZ),
    Scenario("city, rounded to 1e-5 degrees", "clean", "tune", motions.city, _USUAL, _HZ, quantum_deg=1e-5),
    Scenario("stop and go, clean", "clean", "held_out", motions.stop_and_go, noises.normal(2.0), _HZ),
    Scenario("train at 300 km/h, clean", "clean", "held_out", motions.train, _USUAL, _HZ),
    Scenario("stationary, clean", "clean", "held_out", motions.stationary, _USUAL, _HZ, duration_s=1800.0),
    Scenario("circle, clean", "clean", "held_out", motions.circle, _USUAL, _HZ),
    Scenario(
        "walk, rounded to 1e-4 degrees", "clean", "held_out", motions.walk, _USUAL, _HZ, quantum_deg=1e-4
    ),
)

# Held out: shorter and middling correlation times, and a receiver that does not move.
COLOURED = (
    Scenario("city, coloured 10 s", "coloured", "tune", motions.city, noises.coloured(1.5, 4.0, 10.0), _HZ),
    Scenario(
        "walk, coloured 100 s, bursts 10 %",
        "coloured",
        "tune",
        motions.walk,
        noises.coloured(1.0, 3.0, 100.0),
        _HZ,
        (Bursts(0.1, _STEP, 5.0, 25.0),),
    ),
    Scenario(
        "stationary, coloured 40 s",
        "coloured",
        "held_out",
        motions.stationary,
        noises.coloured(1.0, 4.0, 40.0),
        _HZ,
    ),
    Scenario(
        "city, coloured 3 s, spikes 10 %",
        "coloured",
        "held_out",
        motions.city,
        noises.coloured(2.0, 4.0, 3.0),
        _HZ,
        (Spikes(0.1, _FAR),),
    ),
)
