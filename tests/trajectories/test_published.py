"""The published tracks, read in place: do no harm, and gain where there is something to gain."""

import csv
from pathlib import Path

import numpy as np
import pytest

from estimators import Track, clean_trajectory
from estimators.arrays import FloatArray
from estimators.geodesy.plane import Plane


def _read(path: Path) -> dict[str, FloatArray]:
    if not path.is_file():
        pytest.skip(f"{path.name} is not among the published tracks here")
    with path.open() as lines:
        rows = list(csv.DictReader(lines))
    return {name: np.array([float(row[name] or "nan") for row in rows]) for name in rows[0]}


def _clean(columns: dict[str, FloatArray]) -> tuple[Track, FloatArray, FloatArray]:
    """Answer, its errors and those of the raw fixes, in metres, where there is truth."""
    track = clean_trajectory(columns["t"], columns["lat"], columns["lon"], accuracy_m=columns.get("acc"))
    assert isinstance(track, Track)
    known = np.isfinite(columns["lat_true"])
    plane = Plane(float(np.median(columns["lat"])), float(np.median(columns["lon"])))
    truth = plane.project(columns["lat_true"][known], columns["lon_true"][known])
    found = plane.project(track.lat_deg[known], track.lon_deg[known]) - truth
    raw = plane.project(columns["lat"][known], columns["lon"][known]) - truth
    return track, np.hypot(*found.T), np.hypot(*raw.T)


@pytest.mark.parametrize(
    ("name", "most"),
    [
        ("smartloc_potsdamer_wls", 1.02),
        ("urbannav_tokyo_odaiba_wls_1hz", 0.6),
        ("urbannav_tokyo_odaiba_wls_10hz", 0.3),
    ],
)
def test_a_real_drive_is_not_worse_than_its_fixes_and_its_regions_hold(
    track_data: Path, name: str, most: float
) -> None:
    columns = _read(track_data / "real" / f"{name}.csv")
    track, found, raw = _clean(columns)
    assert np.sqrt(np.mean(found**2)) <= most * np.sqrt(np.mean(raw**2))
    sigma = track.sigma_m[np.isfinite(columns["lat_true"])]
    assert np.mean(found**2 / sigma**2 < 5.991) >= 0.8
    assert "drift_unobservable" in {item.code.value for item in track.notices}


@pytest.mark.parametrize("name", ["city_clean", "cv_clean", "rounded", "modechange"])
def test_clean_tracks_keep_their_fixes(track_data: Path, name: str) -> None:
    for seed in (1, 2):
        columns = _read(track_data / "synth" / f"{name}_s{seed}.csv")
        track, found, raw = _clean(columns)
        assert np.mean(~track.points.inlier) <= 0.002
        assert np.sqrt(np.mean(found**2)) < np.sqrt(np.mean(raw**2))


@pytest.mark.parametrize("name", ["city_spk40", "city_burst30", "clockjump", "hz10_burst", "polar", "stuck"])
def test_faults_of_published_tracks_are_found(track_data: Path, name: str) -> None:
    for seed in (1, 2):
        columns = _read(track_data / "synth" / f"{name}_s{seed}.csv")
        track, found, raw = _clean(columns)
        scored, faulty = columns["label"] >= 0.0, columns["label"] == 1.0
        flagged = ~track.points.inlier
        hits = np.count_nonzero(flagged & faulty)
        total = np.count_nonzero(flagged & scored) + np.count_nonzero(faulty)
        assert 2.0 * hits / total > 0.96
        assert np.sqrt(np.mean(found**2)) < 0.2 * np.sqrt(np.mean(raw**2))
