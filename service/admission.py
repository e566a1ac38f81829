"""What is let in: bodies up to a size, and requests up to a number.

:class:`LimitBodies` bounds the bytes of one body, of all bodies in memory and the time a body may take.
:class:`Admission` bounds the fits that run and the requests that wait for one, first come first served.
Nothing here grows with what callers send.
"""

from __future__ import annotations

import asyncio
from collections import deque

from starlette.datastructures import Headers
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from service.errors import Problem, ProblemType
from service.settings import Settings

#: A caller who still writes would see a reset connection in place of an early answer, so what is left of a
#: body is read and dropped for so long, as web servers do when they close.
LINGER_SECONDS = 5.0


class BodyBudget:
    """Bytes of request bodies in memory, over all requests."""

    def __init__(self, limit: int) -> None:
        self.limit = limit
        self.used = 0


class LimitBodies:
    """ASGI middleware that answers 413, 408 or 503 instead of reading more than is allowed.

    Parameters
    ----------
    app : ASGI application
    settings : Settings
    budget : BodyBudget
    """

    def __init__(self, app: ASGIApp, settings: Settings, budget: BodyBudget) -> None:
        self._app = app
        self._limit = settings.max_body_bytes
        self._seconds = settings.body_seconds
        self._budget = budget

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a request on with its body counted."""
        if scope["type"] != "http" or not _announces_body(Headers(scope=scope)):
            await self._app(scope, receive, send)
            return
        body = _CountedBody(receive, self._limit, self._seconds, self._budget)

        async def send_after_body(message: Message) -> None:
            if message["type"] == "http.response.start":
                await body.drop_rest()
            await send(message)

        try:
            length = Headers(scope=scope).get("content-length", "")
            if length.isdecimal() and int(length) > self._limit:
                response = body_too_large(self._limit).to_response(scope["state"]["request_id"])
                await response(scope, receive, send_after_body)
            else:
                await self._app(scope, body.receive, send_after_body)
        finally:
            body.release()


class _CountedBody:
    """A request body that is counted while it arrives."""

    def __init__(self, receive: Receive, limit: int, seconds: float, budget: BodyBudget) -> None:
        self._receive = receive
        self._limit = limit
        self._seconds = seconds
        self._budget = budget
        self._held = 0
        self._complete = False
        self._deadline: float | None = None

    async def receive(self) -> Message:
        if self._complete:
            return await self._receive()
        loop = asyncio.get_running_loop()
        if self._deadline is None:
            self._deadline = loop.time() + self._seconds
        try:
            async with asyncio.timeout_at(self._deadline):
                message = await self._receive()
        except TimeoutError:
            self._complete = True
            raise Problem(ProblemType.request_timeout, headers={"Connection": "close"}) from None
        self._note(message)
        arrived = len(message.get("body", b""))
        self._held += arrived
        self._budget.used += arrived
        if self._held > self._limit:
            raise body_too_large(self._limit)
        if self._budget.used > self._budget.limit:
            raise Problem(
                ProblemType.busy, "too many large bodies at one time; ask again", headers={"Retry-After": "1"}
            )
        return message

    async def drop_rest(self) -> None:
        """Read and forget what is still coming, within bounds, so that the answer can be read."""
        dropped = 0
        try:
            async with asyncio.timeout(LINGER_SECONDS):
                while not self._complete and dropped <= self._limit:
                    message = await self._receive()
                    self._note(message)
                    dropped += len(message.get("body", b""))
        except TimeoutError:
            return

    def release(self) -> None:
        """Give back what this body holds of the budget."""
        self._budget.used -= self._held
        self._held = 0

    def _note(self, message: Message) -> None:
        self._complete = message["type"] == "http.disconnect" or not message.get("more_body", False)


class Admission:
    """Slots for fits and a bounded queue for those who wait, first come first served.

    Runs on one event loop; it needs no lock.

    Parameters
    ----------
    settings : Settings
        ``workers`` slots, ``queue_length`` waiters, ``queue_seconds`` of patience.
    """

    def __init__(self, settings: Settings) -> None:
        self._slots = settings.workers
        self._queue_length = settings.queue_length
        self._patience = settings.queue_seconds
        self._queue: deque[asyncio.Future[None]] = deque()
        self._running = 0

    @property
    def running(self) -> int:
        """Slots taken."""
        return self._running

    @property
    def waiting(self) -> int:
        """Requests in the queue."""
        return len(self._queue)

    def enter_now(self) -> bool:
        """Take a free slot, if there is one and nobody waits."""
        if self._running < self._slots and not self._queue:
            self._running += 1
            return True
        return False

    async def enter(self) -> None:
        """Take a slot, waiting for it if need be.

        Raises
        ------
        Problem
            503 if the queue is full or the wait too long.
        """
        if self.enter_now():
            return
        if len(self._queue) >= self._queue_length:
            raise self._busy("the queue is full")
        turn: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        self._queue.append(turn)
        entered = False
        try:
            async with asyncio.timeout(self._patience):
                await turn
            entered = True
        except TimeoutError:
            raise self._busy("no worker became free in time") from None
        finally:
            if not entered:
                self._withdraw(turn)

    def leave(self) -> None:
        """Give a slot back: to whoever waits longest, or to nobody."""
        while self._queue:
            turn = self._queue.popleft()
            if not turn.done():
                turn.set_result(None)
                return
        self._running -= 1

    def _withdraw(self, turn: asyncio.Future[None]) -> None:
        if turn in self._queue:
            self._queue.remove(turn)
        elif turn.done() and not turn.cancelled():
            # The slot was handed over in the very moment in which its taker gave up.
            self.leave()

    def _busy(self, why: str) -> Problem:
        wait = max(1, round(self._patience))
        return Problem(
            ProblemType.busy, f"{why}; ask again after {wait} s", headers={"Retry-After": str(wait)}
        )


def body_too_large(limit: int) -> Problem:
    """Problem of a body over the limit."""
    return Problem(
        ProblemType.body_too_large,
        f"at most {limit} bytes are taken; send fewer rows",
        headers={"Connection": "close"},
        extra={"limit": limit},
    )


def _announces_body(headers: Headers) -> bool:
    return headers.get("content-length", "0") != "0" or "transfer-encoding" in headers
