from __future__ import annotations

import asyncio
from collections.abc import Coroutine
from typing import Any

import pytest

from service.admission import Admission
from service.errors import Problem, ProblemType
from service.settings import Settings


def admission(workers: int = 1, queue_length: int = 2, queue_seconds: float = 60.0) -> Admission:
    return Admission(Settings(workers=workers, queue_length=queue_length, queue_seconds=queue_seconds))


def run(test: Coroutine[Any, Any, None]) -> None:
    asyncio.run(test)


async def settle() -> None:
    for _ in range(5):
        await asyncio.sleep(0)


def test_slots_are_given_until_they_are_taken() -> None:
    async def test() -> None:
        door = admission(workers=2)
        assert [door.enter_now() for _ in range(3)] == [True, True, False]
        door.leave()
        assert door.enter_now()
        assert door.running == 2

    run(test())


def test_who_waits_longest_is_served_first() -> None:
    async def test() -> None:
        door = admission()
        await door.enter()
        served: list[int] = []

        async def wait(number: int) -> None:
            await door.enter()
            served.append(number)

        tasks = [asyncio.create_task(wait(number)) for number in range(2)]
        await settle()
        assert door.waiting == 2
        for _ in tasks:
            door.leave()
            await settle()
        assert served == [0, 1]
        assert (door.running, door.waiting) == (1, 0)

    run(test())


def test_a_full_queue_is_busy_and_says_when_to_ask_again() -> None:
    async def test() -> None:
        door = admission(queue_length=0, queue_seconds=7)
        await door.enter()
        with pytest.raises(Problem) as caught:
            await door.enter()
        assert caught.value.kind is ProblemType.busy
        assert caught.value.headers["Retry-After"] == "7"
        assert door.running == 1

    run(test())


def test_a_wait_that_is_too_long_is_busy_and_leaves_the_queue() -> None:
    async def test() -> None:
        door = admission(queue_seconds=0.01)
        await door.enter()
        with pytest.raises(Problem) as caught:
            await door.enter()
        assert caught.value.kind is ProblemType.busy
        assert (door.running, door.waiting) == (1, 0)

    run(test())


def test_who_gives_up_leaves_the_queue() -> None:
    async def test() -> None:
        door = admission()
        await door.enter()
        task = asyncio.create_task(door.enter())
        await settle()
        task.cancel()
        await settle()
        assert (door.running, door.waiting) == (1, 0)

    run(test())


def test_a_slot_handed_to_somebody_who_just_gave_up_is_not_lost() -> None:
    async def test() -> None:
        door = admission()
        await door.enter()
        task = asyncio.create_task(door.enter())
        await settle()
        door.leave()
        task.cancel()
        await settle()
        assert task.cancelled()
        assert (door.running, door.waiting) == (0, 0)
        assert door.enter_now()

    run(test())
