"""Run as a program: tracks as JSON on standard input, a peer's answers as JSON on standard output.

It imports nothing of this project, so that it runs in any environment that holds the peer, and a peer only
when it is asked. A peer that raises
an error answers null: what it cannot read is its own.
"""

from __future__ import annotations

import datetime
import json
import math
import sys
import time
from collections.abc import Callable, Mapping
from importlib import import_module
from typing import Any

Tracks = Mapping[str, Any]
Found = dict[str, Any]
_TOLD_MPS = 50.0
_METRES_PER_DEGREE = 111_195.0
_ERRORS = (ValueError, KeyError, IndexError, TypeError, AttributeError, ArithmeticError, RuntimeError)


def _moving_pandas(track: Tracks) -> Any:
    gpd = import_module("geopandas")
    mpd = import_module("movingpandas")
    pd = import_module("pandas")

    points = gpd.points_from_xy(track["lon"], track["lat"])
    times = pd.to_datetime(track["t"], unit="s")
    frame = gpd.GeoDataFrame({"row": range(len(times))}, geometry=points, index=times, crs=4326)
    return mpd.Trajectory(frame, 1)


def _cleaned_by_moving_pandas(track: Tracks, **options: Any) -> Found:
    mpd = import_module("movingpandas")

    trajectory = _moving_pandas(track)
    started = time.process_time()
    cleaned = mpd.OutlierCleaner(trajectory).clean(**options)
    seconds = time.process_time() - started
    kept = {int(row) for row in cleaned.df["row"]}
    return _thinned(track, kept, seconds)


def _thinned(track: Tracks, kept: set[int], seconds: float) -> Found:
    n = len(track["t"])
    return {
        "lat": [track["lat"][k] if k in kept else None for k in range(n)],
        "lon": [track["lon"][k] if k in kept else None for k in range(n)],
        "flagged": [k not in kept for k in range(n)],
        "seconds": seconds,
    }


def by_movingpandas_default(track: Tracks) -> Found:
    """Clean by quantiles of the speed, as it comes."""
    return _cleaned_by_moving_pandas(track)


def by_movingpandas_told(track: Tracks) -> Found:
    """Clean by a highest speed."""
    return _cleaned_by_moving_pandas(track, v_max=_TOLD_MPS, units=("m", "s"))


def by_movingpandas_kalman(track: Tracks) -> Found:
    """Smooth with its own settings; it flags nothing."""
    mpd = import_module("movingpandas")

    trajectory = _moving_pandas(track)
    started = time.process_time()
    smoothed = mpd.KalmanSmootherCV(trajectory).smooth()
    seconds = time.process_time() - started
    at = {int(row): (p.y, p.x) for row, p in zip(smoothed.df["row"], smoothed.df.geometry, strict=True)}
    pairs = [at.get(k, (None, None)) for k in range(len(track["t"]))]
    return {"lat": [p[0] for p in pairs], "lon": [p[1] for p in pairs], "flagged": None, "seconds": seconds}


def by_skmob_told(track: Tracks) -> Found:
    """Filter by a highest speed."""
    pd = import_module("pandas")
    skmob = import_module("skmob")
    filtering = import_module("skmob.preprocessing.filtering")

    times = pd.to_datetime(track["t"], unit="s")
    frame = pd.DataFrame(
        {"lat": track["lat"], "lng": track["lon"], "datetime": times, "row": range(len(times))}
    )
    given = skmob.TrajDataFrame(frame)
    started = time.process_time()
    left = filtering.filter(given, max_speed_kmh=3.6 * _TOLD_MPS)
    seconds = time.process_time() - started
    return _thinned(track, {int(row) for row in left["row"]}, seconds)


def by_gpxpy_smooth(track: Tracks) -> Found:
    """Smooth by weights of neighbours after removing extremes."""
    gpx = import_module("gpxpy.gpx")

    segment = gpx.GPXTrackSegment()
    for t, lat, lon in zip(track["t"], track["lat"], track["lon"], strict=True):
        moment = datetime.datetime.fromtimestamp(t, datetime.UTC)
        segment.points.append(gpx.GPXTrackPoint(lat, lon, elevation=0.0, time=moment))
    rows = {id(point): k for k, point in enumerate(segment.points)}
    # Points are replaced or dropped, never copied: identity tells which row each one was.
    keep = list(segment.points)
    started = time.process_time()
    segment.smooth(vertical=False, horizontal=True, remove_extremes=True)
    seconds = time.process_time() - started
    at = {rows[id(point)]: point for point in segment.points}
    points = [at.get(k) for k in range(len(keep))]
    return {
        "lat": [None if p is None else p.latitude for p in points],
        "lon": [None if p is None else p.longitude for p in points],
        "flagged": [p is None for p in points],
        "seconds": seconds,
    }


def by_filterpy_rts(track: Tracks) -> Found:
    """Smooth with constant velocity in the plane of the first fix, told the noise, density 1 m^2/s^3."""
    np = import_module("numpy")
    kalman_filter = import_module("filterpy.kalman").KalmanFilter

    lat0, lon0 = track["lat"][0], track["lon"][0]
    across = _METRES_PER_DEGREE * math.cos(math.radians(lat0))
    north = (np.array(track["lat"]) - lat0) * _METRES_PER_DEGREE
    east = (np.array(track["lon"]) - lon0) * across
    steps = np.diff(track["t"], prepend=track["t"][0])
    started = time.process_time()
    kalman = kalman_filter(dim_x=4, dim_z=2)
    kalman.H = np.array([[1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]])
    kalman.R = np.eye(2) * (track["sigma"] or 4.0) ** 2
    kalman.P = np.diag([1e4, 1e4, 1e4, 1e4])
    kalman.x = np.array([[east[0]], [0.0], [north[0]], [0.0]])
    moves, drives, states, spreads = [], [], [], []
    for k, dt in enumerate(steps):
        block, drive = np.array([[1.0, dt], [0.0, 1.0]]), np.array([[dt**3 / 3, dt**2 / 2], [dt**2 / 2, dt]])
        move, noise = np.kron(np.eye(2), block), np.kron(np.eye(2), drive)
        kalman.predict(F=move, Q=noise)
        kalman.update(np.array([[east[k]], [north[k]]]))
        moves.append(move)
        drives.append(noise)
        states.append(kalman.x.copy())
        spreads.append(kalman.P.copy())
    smoothed, *_ = kalman.rts_smoother(np.array(states), np.array(spreads), moves, drives)
    seconds = time.process_time() - started
    return {
        "lat": (lat0 + smoothed[:, 2, 0] / _METRES_PER_DEGREE).tolist(),
        "lon": (lon0 + smoothed[:, 0, 0] / across).tolist(),
        "flagged": None,
        "seconds": seconds,
    }


PEERS: Mapping[str, Callable[[Tracks], Found]] = {
    "movingpandas_default": by_movingpandas_default,
    "movingpandas_told": by_movingpandas_told,
    "movingpandas_kalman": by_movingpandas_kalman,
    "skmob_told": by_skmob_told,
    "gpxpy_smooth": by_gpxpy_smooth,
    "filterpy_rts": by_filterpy_rts,
}


def _asked(clean: Callable[[Tracks], Found], track: Tracks) -> Found | None:
    try:
        return clean(track)
    except _ERRORS as error:
        sys.stderr.write(f"{type(error).__name__}: {error}\n")
        return None


def main() -> int:
    """Answer one request."""
    request = json.load(sys.stdin)
    clean = PEERS[request["peer"]]
    answers = [_asked(clean, track) for track in request["tracks"]]
    sys.stdout.write("\n" + json.dumps(answers) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
