"""Tracks without faults, and tracks whose noise lasts."""

from __future__ import annotations

from benchmarks.tracks import motions, noises
from benchmarks.tracks.faults import Bursts, Spikes
from benchmarks.tracks.generator import Scenario
from benchmarks.tracks.scenarios.laws import FAR, HZ, STEP, USUAL

# Held out: motions whose speed or velocity is unlike the tuned ones, and the coarser rounding.
CLEAN = (
    Scenario("walk, clean", "clean", "tune", motions.walk, USUAL, HZ),
    Scenario("city, clean", "clean", "tune", motions.city, USUAL, HZ),
    Scenario("constant velocity, clean", "clean", "tune", motions.constant_velocity, USUAL, HZ),
    Scenario("city, rounded to 1e-5 degrees", "clean", "tune", motions.city, USUAL, HZ, quantum_deg=1e-5),
    Scenario("stop and go, clean", "clean", "held_out", motions.stop_and_go, noises.normal(2.0), HZ),
    Scenario("train at 300 km/h, clean", "clean", "held_out", motions.train, USUAL, HZ),
    Scenario("stationary, clean", "clean", "held_out", motions.stationary, USUAL, HZ, duration_s=1800.0),
    Scenario("circle, clean", "clean", "held_out", motions.circle, USUAL, HZ),
    Scenario("walk, rounded to 1e-4 degrees", "clean", "held_out", motions.walk, USUAL, HZ, quantum_deg=1e-4),
)

# Held out: shorter and middling correlation times, and a receiver that does not move.
COLOURED = (
    Scenario("city, coloured 10 s", "coloured", "tune", motions.city, noises.coloured(1.5, 4.0, 10.0), HZ),
    Scenario(
        "walk, coloured 100 s, bursts 10 %",
        "coloured",
        "tune",
        motions.walk,
        noises.coloured(1.0, 3.0, 100.0),
        HZ,
        (Bursts(0.1, STEP, 5.0, 25.0),),
    ),
    Scenario(
        "stationary, coloured 40 s",
        "coloured",
        "held_out",
        motions.stationary,
        noises.coloured(1.0, 4.0, 40.0),
        HZ,
    ),
    Scenario(
        "city, coloured 3 s, spikes 10 %",
        "coloured",
        "held_out",
        motions.city,
        noises.coloured(2.0, 4.0, 3.0),
        HZ,
        (Spikes(0.1, FAR),),
    ),
)
