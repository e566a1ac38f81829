"""Fixes of a walk northward with one of them far off, as the wire and files carry them."""

from __future__ import annotations

from typing import Any

import numpy as np

SPIKE = 30
N = 60


def walk(n: int = N, east_deg: float = 11.0, seed: int = 1, **fields: Any) -> dict[str, Any]:
    """Columns of one fix a second; the one in row 30 is 1.1 km off."""
    random = np.random.default_rng(seed)
    lat = 48.0 + 1e-4 * np.arange(n) + 2e-5 * random.normal(size=n)
    lat[SPIKE] += 0.01
    longitude = (east_deg + 3e-5 * random.normal(size=n)).tolist()
    return {"time": list(range(n)), "lat": lat.tolist(), "lon": longitude, **fields}


def clock(n: int = N, zone: str = "+02:00") -> list[str]:
    """Times of a walk as ISO 8601 in a zone."""
    return [f"2024-05-01T12:{k // 60:02d}:{k % 60:02d}{zone}" for k in range(n)]


def two_walks() -> dict[str, Any]:
    """Columns of two devices, a row of each in turn; the second appears first."""
    parts = [walk(east_deg=12.0, seed=2), walk(seed=3)]
    joined = {name: [part[name][k] for k in range(N) for part in parts] for name in ("time", "lat", "lon")}
    return {**joined, "device": ["van", "bus"] * N}


def as_csv(fields: dict[str, Any]) -> bytes:
    """Columns as a CSV table; None is an empty cell."""
    rows = zip(*fields.values(), strict=True)
    lines = [",".join("" if cell is None else str(cell) for cell in row) for row in rows]
    return "\n".join([",".join(fields), *lines, ""]).encode()


def as_gpx(fields: dict[str, Any], name: str = "", version: str = "1.1") -> bytes:
    """Columns with ISO 8601 times as GPX."""
    points = "".join(
        f'<trkpt lat="{lat}" lon="{lon}"><time>{time}</time></trkpt>'
        for time, lat, lon in zip(fields["time"], fields["lat"], fields["lon"], strict=True)
    )
    space = f"http://www.topografix.com/GPX/{version.replace('.', '/')}"
    title = f"<name>{name}</name>" if name else ""
    track = f"<trk>{title}<trkseg>{points}</trkseg></trk>"
    return f'<gpx version="{version}" creator="test" xmlns="{space}">{track}</gpx>'.encode()


def as_kml(fields: dict[str, Any]) -> bytes:
    """Columns with ISO 8601 times as KML with a gx:Track."""
    whens = "".join(f"<when>{time}</when>" for time in fields["time"])
    places = "".join(
        f"<gx:coord>{lon} {lat} 0</gx:coord>" for lat, lon in zip(fields["lat"], fields["lon"], strict=True)
    )
    spaces = 'xmlns="http://www.opengis.net/kml/2.2" xmlns:gx="http://www.google.com/kml/ext/2.2"'
    return f"<kml {spaces}><Placemark><gx:Track>{whens}{places}</gx:Track></Placemark></kml>".encode()


def as_geojson(fields: dict[str, Any]) -> dict[str, Any]:
    """Columns as a LineString with ``coordTimes``."""
    line = [[lon, lat] for lat, lon in zip(fields["lat"], fields["lon"], strict=True)]
    return {
        "type": "Feature",
        "geometry": {"type": "LineString", "coordinates": line},
        "properties": {"coordTimes": fields["time"]},
    }
