"""Other cleaners of tracks, each in a process of its own: they ask for other versions of our packages.

``PLUMBLINE_TRACK_PEERS_PYTHON`` names the interpreters of the environments that hold them, as ``PATH`` names
folders (default: this one): some peers cannot live in one environment. A peer is asked in the first where it
can be imported; one that can be imported nowhere is absent from the tables, and the page says so.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType

import numpy as np

from benchmarks.tracks.recording import Recording
from benchmarks.tracks.scores import Answer

_PROGRAM = Path(__file__).with_name("peer_process.py")


@dataclass(frozen=True, slots=True)
class Peer:
    """A way of cleaning in another package.

    Attributes
    ----------
    key : str
        Of the function of :mod:`benchmarks.tracks.peer_process`.
    modules : tuple of str
        What it imports.
    package : str
        Whose version is told.
    """

    key: str
    modules: tuple[str, ...]
    package: str


PEERS: Mapping[str, Peer] = MappingProxyType(
    {
        "MovingPandas OutlierCleaner, default": Peer(
            "movingpandas_default", ("movingpandas",), "movingpandas"
        ),
        "MovingPandas OutlierCleaner, told 50 m/s": Peer(
            "movingpandas_told", ("movingpandas",), "movingpandas"
        ),
        "MovingPandas KalmanSmootherCV": Peer(
            "movingpandas_kalman", ("movingpandas", "stonesoup"), "movingpandas"
        ),
        "scikit-mobility filter, told 50 m/s": Peer("skmob_told", ("skmob",), "scikit-mobility"),
        "gpxpy smooth, extremes removed": Peer("gpxpy_smooth", ("gpxpy",), "gpxpy"),
        "filterpy RTS, told sigma": Peer("filterpy_rts", ("filterpy",), "filterpy"),
    }
)


def interpreters() -> list[str]:
    """Pythons of the peers' environments."""
    return os.environ.get("PLUMBLINE_TRACK_PEERS_PYTHON", sys.executable).split(os.pathsep)


def find_peer(peer: Peer) -> tuple[str, str] | None:
    """Interpreter and version of a peer, or None where it cannot be imported."""
    code = (
        f"import importlib, importlib.metadata as m; [importlib.import_module(x) for x in {peer.modules!r}];"
        f" print(m.version({peer.package!r}))"
    )
    for python in interpreters():
        done = subprocess.run(
            [python, "-W", "ignore", "-c", code], capture_output=True, text=True, check=False
        )
        if done.returncode == 0:
            return python, done.stdout.split()[-1]
    return None


def answer_by_peer(
    python: str, peer: Peer, recordings: Sequence[Recording]
) -> list[tuple[Answer, float] | None]:
    """Clean recordings by a peer.

    Rows are given in order of time, which all of them ask for; positions at rows that a peer drops are
    interpolated from those that it keeps.

    Parameters
    ----------
    python : str
        Interpreter, of :func:`find_peer`.
    peer : Peer
    recordings : sequence of Recording

    Returns
    -------
    list
        Answer and processor time of the peer's own call; None where it raised an error or kept nothing.
    """
    orders = [np.argsort(recording.t_s, kind="stable") for recording in recordings]
    request = {
        "peer": peer.key,
        "tracks": [
            {
                "t": recording.t_s[order].tolist(),
                "lat": recording.lat_deg[order].tolist(),
                "lon": recording.lon_deg[order].tolist(),
                "sigma": float(np.nanmedian(recording.sigma_m))
                if np.isfinite(recording.sigma_m).any()
                else None,
            }
            for recording, order in zip(recordings, orders, strict=True)
        ],
    }
    done = subprocess.run(
        [python, "-W", "ignore", str(_PROGRAM)],
        input=json.dumps(request),
        capture_output=True,
        text=True,
        check=True,
    )
    reply = json.loads(done.stdout.splitlines()[-1])
    return [
        None if found is None else _decode(found, recording, order)
        for found, recording, order in zip(reply, recordings, orders, strict=True)
    ]


def _decode(
    found: Mapping[str, object], recording: Recording, order: np.ndarray[tuple[int], np.dtype[np.int64]]
) -> tuple[Answer, float] | None:
    lat = np.array(found["lat"], dtype=np.float64)
    lon = np.array(found["lon"], dtype=np.float64)
    kept = np.isfinite(lat) & np.isfinite(lon)
    if not kept.any():
        return None
    t = recording.t_s[order]
    unwrapped = np.unwrap(lon[kept], period=360.0)
    columns = np.empty((2, t.size))
    columns[0, order] = np.interp(t, t[kept], lat[kept])
    columns[1, order] = np.interp(t, t[kept], unwrapped)
    flagged = None
    if found["flagged"] is not None:
        flagged = np.zeros(t.size, dtype=np.bool_)
        flagged[order] = np.array(found["flagged"], dtype=np.bool_)
        # Dropping one of two equal rows says nothing against them.
        rows = np.stack([recording.t_s, recording.lat_deg, recording.lon_deg], axis=1)
        _, twin = np.unique(rows, axis=0, return_inverse=True)
        kept_once = np.zeros(t.size, dtype=np.bool_)
        kept_once[twin[~flagged]] = True
        flagged &= ~kept_once[twin]
    return Answer(columns[0], columns[1], flagged), float(str(found["seconds"]))
