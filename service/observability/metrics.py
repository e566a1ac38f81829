"""Prometheus metrics in a registry of their own, so that two apps in a process do not mix."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from prometheus_client import CollectorRegistry, Counter, Gauge, Histogram, ProcessCollector, generate_latest

#: The text format every Prometheus reads; our names need nothing newer.
METRICS_MEDIA_TYPE = "text/plain; version=0.0.4; charset=utf-8"

#: Any other method is counted as ``other``: a label must not grow with what strangers send.
METHODS = frozenset({"GET", "HEAD", "POST", "PUT", "PATCH", "DELETE", "OPTIONS"})

#: A parse takes tens of microseconds, a picture a quarter of a second, the default deadline is 30 s.
BUCKETS = (0.0001, 0.0003, 0.001, 0.003, 0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0)


class Metrics:
    """What is counted.

    Parameters
    ----------
    running, waiting, buffered : callable
        Read at every scrape: fits that run, requests that wait for a worker, bytes of bodies in memory.
    """

    def __init__(
        self, running: Callable[[], float], waiting: Callable[[], float], buffered: Callable[[], float]
    ) -> None:
        self.registry = CollectorRegistry()
        ProcessCollector(registry=self.registry)
        self._requests = Counter(
            "plumbline_requests", "Requests answered.", ["route", "method", "status"], registry=self.registry
        )
        self._request_seconds = Histogram(
            "plumbline_request_seconds",
            "Time from the request line to the end of the answer.",
            ["route"],
            buckets=BUCKETS,
            registry=self.registry,
        )
        self._phase_seconds = Histogram(
            "plumbline_phase_seconds",
            "Time of the phases of a fit: parse, queue, fit, encode.",
            ["phase"],
            buckets=BUCKETS,
            registry=self.registry,
        )
        self._points = Counter("plumbline_points_fitted", "Rows of fitted series.", registry=self.registry)
        gauges = (
            ("plumbline_fits_running", "Fits that run now.", running),
            ("plumbline_queue_depth", "Requests that wait for a worker.", waiting),
            ("plumbline_body_bytes_buffered", "Bytes of request bodies in memory.", buffered),
        )
        for name, meaning, read in gauges:
            Gauge(name, meaning, registry=self.registry).set_function(read)

    def count_request(self, route: str, method: str, status: int, seconds: float) -> None:
        """Count an answered request."""
        label = method if method in METHODS else "other"
        self._requests.labels(route, label, str(status)).inc()
        self._request_seconds.labels(route).observe(seconds)

    def count_fit(self, points: int, phases: Mapping[str, float]) -> None:
        """Count a fit and the time its phases took, in seconds."""
        self._points.inc(points)
        for name, seconds in phases.items():
            self._phase_seconds.labels(name).observe(seconds)

    def exposition(self) -> bytes:
        """Everything in the text format of Prometheus."""
        return generate_latest(self.registry)
