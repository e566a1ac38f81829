"""Where fits run: a bounded pool of threads behind the admission queue, with a deadline.

Kernels release the GIL, so threads are enough. A job whose caller has left or whose deadline has passed is
told so by a flag that kernels look at; it keeps its slot until it has stopped, so that the bound holds.
"""

from __future__ import annotations

import asyncio
import time
from collections.abc import Awaitable, Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any, TypeVar

import numpy as np
from starlette.requests import ClientDisconnect

from estimators.consensus.cancellation import Cancelled
from service.admission import Admission
from service.errors import Problem, ProblemType
from service.observability.timing import Stopwatch
from service.settings import Settings

T = TypeVar("T")


class Patience:
    """Whether somebody still waits for a job; jobs ask between their phases, kernels while they run.

    Parameters
    ----------
    seconds : float
        Until the deadline.

    Attributes
    ----------
    flag : ndarray of uint8, shape (1,)
        Not 0 once nobody waits; for :func:`estimators.consensus.cancellation.cancelled_by`.
    """

    def __init__(self, seconds: float) -> None:
        self._deadline = time.monotonic() + seconds
        self.flag = np.zeros(1, dtype=np.uint8)

    @property
    def left(self) -> float:
        """Seconds until the deadline, not negative."""
        return max(0.0, self._deadline - time.monotonic())

    def give_up(self) -> None:
        """Tell the job that nobody waits."""
        self.flag[0] = 1

    def check(self) -> None:
        """Go on only if somebody waits.

        Raises
        ------
        Cancelled
        """
        if self.flag[0] or self.left == 0.0:
            raise Cancelled


class Compute:
    """Runs jobs off the event loop.

    Parameters
    ----------
    settings : Settings
    admission : Admission
    """

    def __init__(self, settings: Settings, admission: Admission) -> None:
        self._admission = admission
        self._seconds = settings.deadline_seconds
        self._pool = ThreadPoolExecutor(settings.workers, thread_name_prefix="plumbline-fit")

    async def run(self, job: Callable[[Patience], T], disconnected: Awaitable[Any], watch: Stopwatch) -> T:
        """Run a job, unless the caller leaves or the deadline passes first.

        Parameters
        ----------
        job : callable
            Called in a thread with the caller's :class:`Patience`.
        disconnected : awaitable
            Done when the caller has left.
        watch : Stopwatch
            Gets the phase ``queue``.

        Raises
        ------
        Problem
            503 if the queue is full, 504 past the deadline.
        ClientDisconnect
            If the caller left; a job that had not started is then never run.
        """
        patience = Patience(self._seconds)
        leaving = asyncio.ensure_future(disconnected)
        try:
            with watch.phase("queue"):
                if not self._admission.enter_now():
                    await self._first(asyncio.ensure_future(self._admission.enter()), leaving, patience)
            return await self._first(self._submit(job, patience), leaving, patience)
        finally:
            patience.give_up()
            leaving.cancel()

    def close(self) -> None:
        """Wait for the jobs that run and take no more."""
        self._pool.shutdown(wait=True, cancel_futures=True)

    def _submit(self, job: Callable[[Patience], T], patience: Patience) -> asyncio.Future[T]:
        loop = asyncio.get_running_loop()
        running = self._pool.submit(job, patience)
        # The slot is given back when the thread is free, which may be after the caller had their answer.
        running.add_done_callback(lambda _: loop.call_soon_threadsafe(self._admission.leave))
        work = asyncio.wrap_future(running)
        # Of a job that nobody waits for any more nobody asks how it ended, which asyncio would log.
        work.add_done_callback(lambda done: done.cancelled() or done.exception())
        return work

    async def _first(self, work: asyncio.Future[T], leaving: asyncio.Future[Any], patience: Patience) -> T:
        try:
            done, _ = await asyncio.wait(
                {work, leaving}, timeout=patience.left, return_when=asyncio.FIRST_COMPLETED
            )
        finally:
            work.cancel()
        if work in done:
            try:
                return work.result()
            except Cancelled:
                raise Problem(ProblemType.deadline_exceeded) from None
        if leaving in done:
            raise ClientDisconnect
        raise Problem(ProblemType.deadline_exceeded)
