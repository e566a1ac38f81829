"""How long the phases of a request took, for ``Server-Timing`` and the histograms."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager

PHASES = ("parse", "queue", "fit", "encode")


class Stopwatch:
    """Durations of one request's phases, in seconds."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}

    @contextmanager
    def phase(self, name: str) -> Iterator[None]:
        """Time what runs inside; also when it raises."""
        start = time.perf_counter()
        try:
            yield
        finally:
            self.seconds[name] = time.perf_counter() - start

    def server_timing(self) -> str:
        """Value of the header ``Server-Timing``: milliseconds per phase.

        Examples
        --------
        >>> watch = Stopwatch()
        >>> watch.seconds |= {"parse": 0.0012, "queue": 0.0, "fit": 0.0005, "encode": 0.0001}
        >>> watch.server_timing()
        'parse;dur=1.200, queue;dur=0.000, fit;dur=0.500, encode;dur=0.100'
        """
        return ", ".join(
            f"{name};dur={1e3 * self.seconds[name]:.3f}" for name in PHASES if name in self.seconds
        )
