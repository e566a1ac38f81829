from __future__ import annotations

import asyncio
import gc
import threading
from collections.abc import Callable, Coroutine
from typing import Any

import pytest
from starlette.requests import ClientDisconnect

from estimators.consensus.cancellation import Cancelled
from service.admission import Admission
from service.compute import Compute, Patience
from service.errors import Problem, ProblemType
from service.observability.timing import Stopwatch
from service.settings import Settings


class Bench:
    """A pool with one worker, and a caller who leaves when told to."""

    def __init__(self, **settings: float) -> None:
        chosen = Settings(workers=1, **settings)  # type: ignore[arg-type]
        self.admission = Admission(chosen)
        self.compute = Compute(chosen, self.admission)
        self.left = asyncio.Event()

    async def run(self, job: Callable[[Patience], Any]) -> Any:
        return await self.compute.run(job, self.left.wait(), Stopwatch())

    async def idle(self) -> None:
        """Wait until no job holds a slot."""
        while self.admission.running:
            await asyncio.sleep(0.001)


def run(test: Coroutine[Any, Any, None]) -> None:
    asyncio.run(asyncio.wait_for(test, 30))


def test_a_job_runs_in_another_thread_and_gives_its_slot_back() -> None:
    async def test() -> None:
        bench = Bench()
        assert await bench.run(lambda _: threading.current_thread().name) != threading.current_thread().name
        assert bench.admission.running == 0

    run(test())


def test_what_a_job_raises_reaches_the_caller_and_its_slot_is_given_back() -> None:
    async def test() -> None:
        bench = Bench()

        def job(_: Patience) -> None:
            raise Problem(ProblemType.no_fit)

        with pytest.raises(Problem) as caught:
            await bench.run(job)
        assert caught.value.kind is ProblemType.no_fit
        assert bench.admission.running == 0

    run(test())


def test_past_the_deadline_the_caller_is_told_and_the_job_is_abandoned_at_its_next_phase() -> None:
    async def test() -> None:
        bench = Bench(deadline_seconds=0.05)
        go_on, outcome = threading.Event(), []

        def job(patience: Patience) -> None:
            go_on.wait(20)
            try:
                patience.check()
            except Cancelled:
                outcome.append("abandoned")
                raise

        with pytest.raises(Problem) as caught:
            await bench.run(job)
        assert caught.value.kind is ProblemType.deadline_exceeded
        assert bench.admission.running == 1, "the thread still runs, so its slot is not free"
        go_on.set()
        await bench.idle()
        assert outcome == ["abandoned"]

    run(test())


def test_a_caller_who_leaves_ends_the_wait_for_a_running_job() -> None:
    async def test() -> None:
        bench = Bench()
        started, go_on = threading.Event(), threading.Event()

        def job(_: Patience) -> None:
            started.set()
            go_on.wait(20)

        task = asyncio.create_task(bench.run(job))
        await asyncio.to_thread(started.wait, 20)
        bench.left.set()
        with pytest.raises(ClientDisconnect):
            await task
        go_on.set()
        await bench.idle()

    run(test())


def test_a_job_whose_caller_leaves_while_it_waits_is_never_run() -> None:
    async def test() -> None:
        bench, other = Bench(), asyncio.Event()
        go_on, ran = threading.Event(), []
        running = asyncio.create_task(bench.run(lambda _: go_on.wait(20)))
        waiting = asyncio.create_task(bench.compute.run(lambda _: ran.append(1), other.wait(), Stopwatch()))
        while bench.admission.waiting == 0:
            await asyncio.sleep(0.001)
        other.set()
        with pytest.raises(ClientDisconnect):
            await waiting
        go_on.set()
        await running
        await bench.idle()
        assert ran == []
        assert bench.admission.waiting == 0

    run(test())


def test_the_deadline_counts_the_time_in_the_queue() -> None:
    async def test() -> None:
        bench = Bench(deadline_seconds=0.05, queue_seconds=60)
        go_on = threading.Event()
        first = asyncio.create_task(bench.run(lambda _: go_on.wait(20)))
        while bench.admission.running == 0:
            await asyncio.sleep(0.001)
        with pytest.raises(Problem) as caught:
            await bench.run(lambda _: None)
        assert caught.value.kind is ProblemType.deadline_exceeded
        go_on.set()
        with pytest.raises(Problem):
            await first
        await bench.idle()

    run(test())


def test_the_time_in_the_queue_is_measured() -> None:
    async def test() -> None:
        bench, watch = Bench(), Stopwatch()
        await bench.compute.run(lambda _: None, bench.left.wait(), watch)
        assert watch.seconds["queue"] >= 0

    run(test())


def test_a_request_that_is_cancelled_while_it_waits_takes_no_slot() -> None:
    async def test() -> None:
        bench = Bench()
        may_end = threading.Event()
        busy = asyncio.ensure_future(bench.run(lambda _: may_end.wait(30)))
        await asyncio.sleep(0)
        waiting = asyncio.ensure_future(bench.run(lambda _: None))
        while not bench.admission.waiting:
            await asyncio.sleep(0.001)
        waiting.cancel()
        with pytest.raises(asyncio.CancelledError):
            await waiting
        may_end.set()
        assert await busy
        await bench.idle()
        assert bench.admission.waiting == 0

    run(test())


def test_a_job_whose_request_was_cancelled_ends_in_silence() -> None:
    async def test() -> None:
        said: list[dict[str, Any]] = []
        asyncio.get_running_loop().set_exception_handler(lambda _loop, what: said.append(what))
        bench = Bench()
        begun = threading.Event()

        def job(patience: Patience) -> None:
            begun.set()
            while True:
                patience.check()

        request = asyncio.ensure_future(bench.run(job))
        await asyncio.to_thread(begun.wait, 30)
        request.cancel()
        with pytest.raises(asyncio.CancelledError):
            await request
        await bench.idle()
        del request
        gc.collect()
        assert said == []

    run(test())
