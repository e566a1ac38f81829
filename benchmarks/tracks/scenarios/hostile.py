"""Tracks on which cleaners break: odd noise, lasting offsets, few fixes, rows in disorder."""

from __future__ import annotations

from benchmarks.tracks import motions, noises, offsets, samplings
from benchmarks.tracks.disorder import Repeated, Unsorted, WrongClock
from benchmarks.tracks.faults import Bursts, FromTheStart, Spikes, Stuck, ToTheEnd
from benchmarks.tracks.generator import Scenario

_HZ = samplings.every(1.0)
_USUAL = noises.normal(4.0)
_FAR = offsets.scattered(60.0, 3000.0)
_NEAR = offsets.scattered(40.0, 300.0)
_STEP = offsets.constant(40.0, 400.0)
_WALK = offsets.random_walk(50.0, 300.0, 2.0)
_BACK = offsets.returning(150.0, 600.0, 12.0)
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
        _HZ,
        (Bursts(0.1, _STEP, 5.0, 25.0), Spikes(0.1, _FAR)),
    ),
    Scenario(
        "city, wandering 30-90 s, 25 %",
        "hard",
        "tune",
        motions.city,
        _USUAL,
        _HZ,
        (Bursts(0.25, _SWAY, 30.0, 90.0),),
    ),
    Scenario(
        "walk, Student's t noise, wandering 25 %",
        "hard",
        "tune",
        motions.walk,
        noises.student(3.0, 4.0),
        _HZ,
        (Bursts(0.25, _SWAY, 20.0, 60.0),),
    ),
    Scenario(
        "walk, Laplace noise, mixed 20 %",
        "hard",
        "held_out",
        motions.walk,
        noises.laplace(5.0),
        _HZ,
        (Bursts(0.1, _BACK, 5.0, 25.0), Spikes(0.1, _NEAR)),
    ),
    Scenario(
        "stop and go, creeping 30-60 s, 20 %",
        "hard",
        "held_out",
        motions.stop_and_go,
        _USUAL,
        _HZ,
        (Bursts(0.2, _CREEP, 30.0, 60.0),),
    ),
    Scenario(
        "city, sigma 9 m, mixed 20 %",
        "hard",
        "held_out",
        motions.city,
        noises.normal(9.0),
        _HZ,
        (Bursts(0.1, _STEP, 5.0, 25.0), Spikes(0.1, _NEAR)),
    ),
)

# Held out: times at random and bursts; tuned: a regular fleet.
SPARSE = (
    Scenario(
        "city every 30 s, spikes 10 %",
        "sparse",
        "tune",
        motions.city,
        _USUAL,
        samplings.every(30.0),
        (Spikes(0.1, offsets.scattered(300.0, 5000.0)),),
        duration_s=7200.0,
    ),
    Scenario(
        "train every 10 s, spikes 10 %",
        "sparse",
        "tune",
        motions.train,
        _USUAL,
        samplings.every(10.0),
        (Spikes(0.1, offsets.scattered(300.0, 5000.0)),),
        duration_s=3600.0,
    ),
    Scenario(
        "city at random every 20 s, mixed 20 %",
        "sparse",
        "held_out",
        motions.city,
        _USUAL,
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
        _USUAL,
        _HZ,
        (Spikes(0.1, _FAR),),
        disorder=(Repeated(0.1), Unsorted(0.2, 8)),
    ),
    Scenario(
        "city, reported accuracy, mixed 15 %",
        "other",
        "tune",
        motions.city,
        noises.reported(2.0, 25.0),
        _HZ,
        (Bursts(0.1, _STEP, 5.0, 25.0), Spikes(0.05, _FAR)),
    ),
    Scenario(
        "walk, cold start",
        "other",
        "tune",
        motions.walk,
        _USUAL,
        _HZ,
        (FromTheStart(0.05, offsets.returning(200.0, 1000.0, 15.0)),),
    ),
    Scenario(
        "city over the antimeridian, mixed 20 %",
        "other",
        "tune",
        motions.city,
        _USUAL,
        _HZ,
        (Bursts(0.1, _STEP, 5.0, 25.0), Spikes(0.1, _FAR)),
        place=(-16.8, 179.9995),
    ),
    Scenario(
        "city, clock jumps",
        "other",
        "held_out",
        motions.city,
        _USUAL,
        _HZ,
        clock=WrongClock(0.08, 5.0, 20.0, 30.0, 200.0),
    ),
    Scenario(
        "city, stuck receiver", "other", "held_out", motions.city, _USUAL, _HZ, (Stuck(0.12, 8.0, 30.0),)
    ),
    Scenario(
        "constant velocity, slow drift",
        "other",
        "held_out",
        motions.constant_velocity,
        _USUAL,
        _HZ,
        (ToTheEnd(0.6, offsets.ramp(60.0, 150.0)),),
    ),
    Scenario(
        "walk, then a car, mixed 15 %",
        "other",
        "held_out",
        motions.walk_then_drive,
        _USUAL,
        _HZ,
        (Bursts(0.1, _WALK, 5.0, 20.0), Spikes(0.05, _FAR)),
    ),
    Scenario(
        "walk at the pole, mixed 20 %",
        "other",
        "held_out",
        motions.walk,
        _USUAL,
        _HZ,
        (Bursts(0.1, _STEP, 5.0, 25.0), Spikes(0.1, _NEAR)),
        place=(89.999, 30.0),
    ),
)
