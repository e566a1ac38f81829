"""Tracks on which cleaners break: odd noise, lasting offsets, few fixes, rows in disorder."""

from __future__ import annotations

from benchmarks.tracks import motions, noises, offsets, samplings
from benchmarks.tracks.disorder import Repeated, Unsorted, WrongClock
from benchmarks.tracks.faults import Bursts, FromTheStart, Spikes, Stuck, ToTheEnd
from benchmarks.tracks.generator import Scenario
from benchmarks.tracks.scenarios.laws import BACK, FAR, HZ, NEAR, STEP, USUAL, WALK

_SWAY = offsets.wandering(40.0, 120.0, 0.3, 15.0)
_CREEP = offsets.ramp(40.0, 100.0)

# Held out: the lighter tail, offsets that creep in, and noise as large as small faults.
HARD = (
    Scenario(
        "city, Student's t noise, mixed 20 %",
        "hard",
        "tune",
        motions.city,
        noises.student(4.0, 2.5),
        HZ,
        (Bursts(0.1, STEP, 5.0, 25.0), Spikes(0.1, FAR)),
    ),
    Scenario(
        "city, wandering 30-90 s, 25 %",
        "hard",
        "tune",
        motions.city,
        USUAL,
        HZ,
        (Bursts(0.25, _SWAY, 30.0, 90.0),),
    ),
    Scenario(
        "walk, Student's t noise, wandering 25 %",
        "hard",
        "tune",
        motions.walk,
        noises.student(3.0, 4.0),
        HZ,
        (Bursts(0.25, _SWAY, 20.0, 60.0),),
    ),
    Scenario(
        "walk, Laplace noise, mixed 20 %",
        "hard",
        "held_out",
        motions.walk,
        noises.laplace(5.0),
        HZ,
        (Bursts(0.1, BACK, 5.0, 25.0), Spikes(0.1, NEAR)),
    ),
    Scenario(
        "stop and go, creeping 30-60 s, 20 %",
        "hard",
        "held_out",
        motions.stop_and_go,
        USUAL,
        HZ,
        (Bursts(0.2, _CREEP, 30.0, 60.0),),
    ),
    Scenario(
        "city, sigma 9 m, mixed 20 %",
        "hard",
        "held_out",
        motions.city,
        noises.normal(9.0),
        HZ,
        (Bursts(0.1, STEP, 5.0, 25.0), Spikes(0.1, NEAR)),
    ),
)

# Held out: times at random and bursts; tuned: a regular fleet.
SPARSE = (
    Scenario(
        "city every 30 s, spikes 10 %",
        "sparse",
        "tune",
        motions.city,
        USUAL,
        samplings.every(30.0),
        (Spikes(0.1, offsets.scattered(300.0, 5000.0)),),
        duration_s=7200.0,
    ),
    Scenario(
        "train every 10 s, spikes 10 %",
        "sparse",
        "tune",
        motions.train,
        USUAL,
        samplings.every(10.0),
        (Spikes(0.1, offsets.scattered(300.0, 5000.0)),),
        duration_s=3600.0,
    ),
    Scenario(
        "city at random every 20 s, mixed 20 %",
        "sparse",
        "held_out",
        motions.city,
        USUAL,
        samplings.at_random(20.0, 5.0),
        (Bursts(0.1, offsets.constant(300.0, 2000.0), 40.0, 150.0), Spikes(0.1, offsets.clumped(2000.0))),
        duration_s=7200.0,
    ),
)

# Held out: faults of the clock, of a stuck receiver and of drift, each without a tuned twin.
OTHER = (
    Scenario(
        "city, repeated and unsorted, spikes 10 %",
        "other",
        "tune",
        motions.city,
        USUAL,
        HZ,
        (Spikes(0.1, FAR),),
        disorder=(Repeated(0.1), Unsorted(0.2, 8)),
    ),
    Scenario(
        "city, reported accuracy, mixed 15 %",
        "other",
        "tune",
        motions.city,
        noises.reported(2.0, 25.0),
        HZ,
        (Bursts(0.1, STEP, 5.0, 25.0), Spikes(0.05, FAR)),
    ),
    Scenario(
        "walk, cold start",
        "other",
        "tune",
        motions.walk,
        USUAL,
        HZ,
        (FromTheStart(0.05, offsets.returning(200.0, 1000.0, 15.0)),),
    ),
    Scenario(
        "city over the antimeridian, mixed 20 %",
        "other",
        "tune",
        motions.city,
        USUAL,
        HZ,
        (Bursts(0.1, STEP, 5.0, 25.0), Spikes(0.1, FAR)),
        place=(-16.8, 179.9995),
    ),
    Scenario(
        "city, clock jumps",
        "other",
        "held_out",
        motions.city,
        USUAL,
        HZ,
        clock=WrongClock(0.08, 5.0, 20.0, 30.0, 200.0),
    ),
    Scenario("city, stuck receiver", "other", "held_out", motions.city, USUAL, HZ, (Stuck(0.12, 8.0, 30.0),)),
    Scenario(
        "constant velocity, slow drift",
        "other",
        "held_out",
        motions.constant_velocity,
        USUAL,
        HZ,
        (ToTheEnd(0.6, offsets.ramp(60.0, 150.0)),),
    ),
    Scenario(
        "walk, then a car, mixed 15 %",
        "other",
        "held_out",
        motions.walk_then_drive,
        USUAL,
        HZ,
        (Bursts(0.1, WALK, 5.0, 20.0), Spikes(0.05, FAR)),
    ),
    Scenario(
        "walk at the pole, mixed 20 %",
        "other",
        "held_out",
        motions.walk,
        USUAL,
        HZ,
        (Bursts(0.1, STEP, 5.0, 25.0), Spikes(0.1, NEAR)),
        place=(89.999, 30.0),
    ),
)
