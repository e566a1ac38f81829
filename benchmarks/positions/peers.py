"""sidereon and gnss_lib_py, each in a process of its own: the latter asks for other versions of our packages.

``PLUMBLINE_PEERS_PYTHON`` names the interpreter of the environment that holds them (default: this one). A
peer that cannot be imported there is absent from the tables, and the page says so.
"""

from __future__ import annotations

import gzip
import json
import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from benchmarks.positions.answers import Answer
from benchmarks.positions.faults import Faulty
from benchmarks.positions.sky import Sky, Station

_PROGRAM = Path(__file__).with_name("peer_process.py")


def interpreter() -> str:
    """Python of the peers' environment."""
    return os.environ.get("PLUMBLINE_PEERS_PYTHON", sys.executable)


def peer_version(peer: str) -> str | None:
    """Version of a peer, or None where it is absent."""
    code = f"import importlib.metadata as m; import {peer}; print(m.version({peer!r}))"
    done = subprocess.run([interpreter(), "-c", code], capture_output=True, text=True, check=False)
    return done.stdout.split()[-1] if done.returncode == 0 else None


def answer_by_peer(
    peer: str, station: Station, data: Path, clean: Sequence[Sky], faulty: Sequence[Faulty]
) -> tuple[list[Answer], float]:
    """Positions by a peer.

    Parameters
    ----------
    peer : str
        ``sidereon`` or ``gnss_lib_py``.
    station : Station
    data : pathlib.Path
        Folder of the stations.
    clean : sequence of Sky
        Healthy epochs, on which a threshold is tuned.
    faulty : sequence of Faulty

    Returns
    -------
    answers : list of Answer
    ms : float
        Processor time per epoch, of the solver alone.
    """
    folder = data / station.folder
    request = {
        "peer": peer,
        "navigation": _text(folder / station.navigation),
        "observations": _text(folder / station.observations),
        "clean": [_as_dict(sky) for sky in clean],
        "epochs": [_as_dict(given.sky) for given in faulty],
    }
    done = subprocess.run(
        [interpreter(), "-W", "ignore", str(_PROGRAM)],
        input=json.dumps(request),
        capture_output=True,
        text=True,
        check=True,
    )
    reply = json.loads(done.stdout.splitlines()[-1])
    answers = [
        Answer(
            None if found["position"] is None else np.array(found["position"]),
            np.array([name in found["used"] for name in given.sky.name]),
        )
        for given, found in zip(faulty, reply["answers"], strict=True)
    ]
    return answers, 1e3 * float(reply["seconds"]) / len(faulty)


def _text(path: Path) -> str:
    opened = gzip.open if path.suffix == ".gz" else open
    with opened(path, "rt", encoding="ascii", errors="replace") as lines:
        return str(lines.read())


def _as_dict(sky: Sky) -> dict[str, object]:
    return {
        "time_s": sky.time_s,
        "name": sky.name,
        "satellites_m": sky.satellites_m.tolist(),
        "ranges_m": sky.ranges_m.tolist(),
        "raw_m": sky.raw_m.tolist(),
        "sigma_m": sky.sigma_m.tolist(),
        "truth_m": sky.truth_m.tolist(),
    }
