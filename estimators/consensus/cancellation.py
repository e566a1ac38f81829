"""Ending a search from outside: a flag that compiled code looks at between chunks of work.

A caller with a deadline runs the fit inside :func:`cancelled_by` and sets the flag from any other thread;
the search then raises :class:`Cancelled` within milliseconds. The flag travels in a context variable, so
that no method and no verb has to carry it as an argument.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar

import numpy as np

from estimators.arrays import CodeArray

_NEVER: CodeArray = np.zeros(1, dtype=np.uint8)
_NEVER.flags.writeable = False
_flag: ContextVar[CodeArray] = ContextVar("cancel_flag", default=_NEVER)


class Cancelled(Exception):  # noqa: N818  # named as concurrent.futures and asyncio name theirs
    """The caller ended the search before it was done."""


@contextmanager
def cancelled_by(flag: CodeArray) -> Iterator[None]:
    """Let ``flag`` end the searches run inside the block.

    Parameters
    ----------
    flag : ndarray of uint8, shape (1,)
        Set its element to 1, from any thread, to cancel.

    Examples
    --------
    >>> flag = np.zeros(1, dtype=np.uint8)
    >>> with cancelled_by(flag):
    ...     cancel_flag() is flag
    True
    """
    token = _flag.set(flag)
    try:
        yield
    finally:
        _flag.reset(token)


def stop_if_cancelled() -> None:
    """Go on only if nobody has set the flag: for what runs between two kernels.

    Raises
    ------
    Cancelled
        If the caller's flag was set.
    """
    if _flag.get()[0]:
        raise Cancelled


def cancel_flag() -> CodeArray:
    """Return the flag that compiled code should poll; outside :func:`cancelled_by`, one that is never set."""
    return _flag.get()
