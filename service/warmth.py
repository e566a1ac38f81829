"""The moments before the first request: which compiled code is there.

The usual fit needs a few of the kernels, so a start loads these first. If they came from the cache the
service is ready: the others are read behind it, those of positions first and then one by one, and a request
that needs one earlier reads it itself, which takes milliseconds. If anything had to be compiled the cache was
made by another version or for another processor, and the service is ready only once everything is loaded: no
fit waits for a compiler.
"""

from __future__ import annotations

import asyncio
import importlib
import threading
import time
from collections.abc import Callable
from importlib.util import find_spec

import numpy as np
from numba.core.event import Event, Listener, install_listener
from structlog.typing import FilteringBoundLogger

from estimators import Epoch, fit_trend, kernels, locate, locate_series
from estimators.geodesy.ellipsoid import to_cartesian
from service.errors import Problem, ProblemType

#: How often a request that came too early looks whether the service is ready.
POLL_SECONDS = 0.02

#: Between one kernel and the next once requests come: loading holds the interpreter.
BREATH_SECONDS = 0.005

#: A kernel comes from the cache in less; the log is not written to by a thread that outlives its app.
STOP_SECONDS = 1.0

#: What the first batch, the first crossing of a curve, the first file and the first track import; it is there
#: before they come.
LATE_MODULES = (
    "service.batches",
    "service.codecs.batch.parquet",
    "scipy.optimize",
    "service.codecs.positions.tables",
    "service.codecs.trajectories.files",
    "service.codecs.trajectories.files_out",
    "service.codecs.trajectories.live",
)

#: Where the extra [rinex] is installed.
READER_OF_RINEX, NEEDED_BY_IT = "estimators.adapters.rinex", "sidereon"


class Warmth:
    """Loads all compiled code in the background, once per process.

    Parameters
    ----------
    log : structlog logger

    Attributes
    ----------
    loaded, total : int
        Kernels loaded so far, and in all; ``total`` is 0 until it is known.
    """

    def __init__(self, log: FilteringBoundLogger) -> None:
        self._log = log
        self._stop = threading.Event()
        self._ready = threading.Event()
        self._thread = threading.Thread(target=self._load, name="plumbline-warm", daemon=True)
        self.loaded = 0
        self.total = 0

    @property
    def is_ready(self) -> bool:
        """Whether a fit would run without compiling anything."""
        return self._ready.is_set()

    @property
    def has_failed(self) -> bool:
        """Whether loading ended without success; the log tells why."""
        return self._thread.ident is not None and not self._thread.is_alive() and not self.is_ready

    def start(self) -> None:
        """Begin; returns at once."""
        self._thread.start()

    async def wait(self, seconds: float) -> None:
        """Wait until the service is ready; returns at once in all but the first moments of a process.

        Raises
        ------
        Problem
            503 if that takes longer than some seconds, or has failed.
        """
        give_up = time.monotonic() + seconds
        while not self.is_ready:
            if self.has_failed or time.monotonic() > give_up:
                raise self.not_ready()
            await asyncio.sleep(POLL_SECONDS)

    def not_ready(self) -> Problem:
        """Problem that says how far loading has come."""
        if self.has_failed:
            return Problem(ProblemType.not_ready, "compiled code could not be loaded; the log tells why")
        detail = f"{self.loaded} of {self.total or 'all'} compiled functions are loaded"
        return Problem(ProblemType.not_ready, detail, headers={"Retry-After": "1"})

    def stop(self) -> None:
        """Stop after the kernel that is being loaded; one that has to be compiled is not waited for."""
        self._stop.set()
        if self._thread.is_alive():
            self._thread.join(STOP_SECONDS)

    def _load(self) -> None:
        start = time.perf_counter()
        for done, total, _name in kernels.warm():
            self.loaded, self.total = done, total
            if done == 1 and not load_usual(lambda: self._log.info("compiling")):
                self._get_ready(start)
                load_positions()
            if self._stop.wait(BREATH_SECONDS if self.is_ready else 0.0):
                return
        for module in LATE_MODULES:
            importlib.import_module(module)
        if find_spec(NEEDED_BY_IT) is not None:
            importlib.import_module(READER_OF_RINEX)
        if not self.is_ready:
            self._get_ready(start)

    def _get_ready(self, start: float) -> None:
        if self._stop.is_set():
            return
        self._log.info("ready", kernels=self.total, seconds=round(time.perf_counter() - start, 3))
        self._ready.set()


def load_usual(compiling: Callable[[], object]) -> bool:
    """Load what the usual fit needs, compiled code and modules that are imported late alike.

    Parameters
    ----------
    compiling : callable
        Called once, if and when something turns out not to be in the cache.

    Returns
    -------
    bool
        Whether anything had to be compiled.
    """
    watch = _Compilations(compiling)
    with install_listener("numba:compile", watch):
        # Few points are searched in another way than many.
        for size in (8, 32):
            times = np.arange(float(size))
            values = times + 0.1 * np.sin(7.0 * times)
            values[size // 2] += 100.0
            fit_trend(times, values)
    return watch.met


def load_positions() -> None:
    """Load what the usual position and a short series need."""
    here = to_cartesian(np.array([52.5, 13.4, 80.0]))
    sky = [[60, 10], [20, -30], [48, 40], [75, 100], [30, 60], [52, -10], [40, 13]]
    satellites = to_cartesian(np.array([[lat, lon, 20.2e6] for lat, lon in sky]))
    ranges = np.linalg.norm(satellites - here, axis=1)
    ranges[3] += 100.0
    locate(satellites, ranges)
    epochs = [Epoch(float(k), satellites, ranges) for k in range(3)]
    for motion in ("static", "moving"):
        locate_series(epochs, motion=motion)


class _Compilations(Listener):
    """Whether numba compiles anything."""

    def __init__(self, compiling: Callable[[], object]) -> None:
        self._compiling = compiling
        self.met = False

    def on_start(self, event: Event) -> None:  # noqa: ARG002  # the interface is numba's
        if not self.met:
            self.met = True
            self._compiling()

    def on_end(self, event: Event) -> None:
        """Nothing is to be done at the end of a compilation."""
