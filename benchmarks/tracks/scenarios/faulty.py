"""Tracks with spikes, with bursts and with both, in usual noise."""

from __future__ import annotations

from benchmarks.tracks import motions, noises, offsets, samplings
from benchmarks.tracks.faults import Bursts, Spikes
from benchmarks.tracks.generator import Scenario
from benchmarks.tracks.scenarios.laws import BACK, FAR, HZ, NEAR, STEP, USUAL, WALK

_CLUMP = offsets.clumped(400.0)
_RAMP = offsets.ramp(60.0, 300.0)

# Held out: the highest share, offsets of a normal law instead of a logarithmic one, and a fixed false place.
SPIKES = (
    Scenario("city, spikes 5 %", "spikes", "tune", motions.city, USUAL, HZ, (Spikes(0.05, FAR),)),
    Scenario("city, spikes 20 %", "spikes", "tune", motions.city, USUAL, HZ, (Spikes(0.2, FAR),)),
    Scenario("walk, near spikes 10 %", "spikes", "tune", motions.walk, USUAL, HZ, (Spikes(0.1, NEAR),)),
    Scenario("circle, spikes 40 %", "spikes", "held_out", motions.circle, USUAL, HZ, (Spikes(0.4, FAR),)),
    Scenario("train, spikes 15 %", "spikes", "held_out", motions.train, USUAL, HZ, (Spikes(0.15, _CLUMP),)),
    Scenario(
        "walk, fixes at (0, 0)",
        "spikes",
        "held_out",
        motions.walk,
        USUAL,
        HZ,
        (Spikes(0.05, FAR),),
        zeroed=True,
    ),
)

# Held out: ramps and returns, which begin or end without a jump, and the fastest motion.
BURSTS = (
    Scenario(
        "city, constant bursts 15 %",
        "bursts",
        "tune",
        motions.city,
        USUAL,
        HZ,
        (Bursts(0.15, STEP, 5.0, 25.0),),
    ),
    Scenario(
        "city, walking bursts 30 %",
        "bursts",
        "tune",
        motions.city,
        USUAL,
        HZ,
        (Bursts(0.3, WALK, 5.0, 30.0),),
    ),
    Scenario(
        "walk, ramps 15 %", "bursts", "held_out", motions.walk, USUAL, HZ, (Bursts(0.15, _RAMP, 8.0, 20.0),)
    ),
    Scenario(
        "stop and go, returning bursts 20 %",
        "bursts",
        "held_out",
        motions.stop_and_go,
        USUAL,
        HZ,
        (Bursts(0.2, BACK, 10.0, 30.0),),
    ),
    Scenario(
        "train, constant bursts 20 %",
        "bursts",
        "held_out",
        motions.train,
        USUAL,
        HZ,
        (Bursts(0.2, STEP, 5.0, 25.0),),
    ),
    Scenario(
        "stationary, walking bursts 20 %",
        "bursts",
        "tune",
        motions.stationary,
        USUAL,
        HZ,
        (Bursts(0.2, WALK, 5.0, 30.0),),
    ),
)

# Held out: returning bursts with normal spikes, ten fixes a second, and times that jitter.
MIXED = (
    Scenario(
        "city, mixed 25 %",
        "mixed",
        "tune",
        motions.city,
        USUAL,
        HZ,
        (Bursts(0.15, STEP, 5.0, 25.0), Spikes(0.1, FAR)),
    ),
    Scenario(
        "city with gaps, mixed 20 %",
        "mixed",
        "tune",
        motions.city,
        USUAL,
        samplings.with_gaps(1.0, 4, 20.0, 60.0),
        (Bursts(0.1, WALK, 5.0, 20.0), Spikes(0.1, FAR)),
    ),
    Scenario(
        "walk, irregular sampling, mixed 20 %",
        "mixed",
        "tune",
        motions.walk,
        USUAL,
        samplings.at_random(2.0, 0.3),
        (Bursts(0.1, STEP, 10.0, 30.0), Spikes(0.1, NEAR)),
        duration_s=1800.0,
    ),
    Scenario(
        "stop and go, mixed 30 %",
        "mixed",
        "held_out",
        motions.stop_and_go,
        USUAL,
        HZ,
        (Bursts(0.2, BACK, 8.0, 25.0), Spikes(0.1, _CLUMP)),
    ),
    Scenario(
        "city at 10 Hz, mixed 20 %",
        "mixed",
        "held_out",
        motions.city,
        noises.normal(2.0),
        samplings.every(0.1),
        (Bursts(0.15, WALK, 4.0, 15.0), Spikes(0.05, _CLUMP)),
        duration_s=180.0,
    ),
    Scenario(
        "train, jittered sampling, mixed 20 %",
        "mixed",
        "held_out",
        motions.train,
        USUAL,
        samplings.jittered(1.0, 0.8),
        (Bursts(0.1, WALK, 5.0, 20.0), Spikes(0.1, _CLUMP)),
    ),
)
