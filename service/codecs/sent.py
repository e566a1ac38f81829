"""A body as it came, whatever is in it: :class:`Sent`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, TypeVar

from service.codecs.limits import Limits

Query = TypeVar("Query")


@dataclass(frozen=True, slots=True)
class Sent(Generic[Query]):
    """A body, and what bounds its reading.

    Attributes
    ----------
    content : bytes
    content_type : str
        With its parameters.
    query : Query
        Parameters of the request.
    limits : Limits
    check : callable
        Called between pieces; raises if nobody waits any more.
    """

    content: bytes
    content_type: str
    query: Query
    limits: Limits
    check: Callable[[], None]
