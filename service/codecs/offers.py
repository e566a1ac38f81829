"""Formats of answers and how one of them is chosen: ``?format=`` first, then ``Accept``."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol, TypeVar

from service.codecs.negotiation import best_offer


class Offer(Protocol):
    """A format of answers."""

    @property
    def name(self) -> str:
        """As in ``?format=``."""
        ...

    @property
    def media_type(self) -> str:
        """As in ``Accept``, without parameters."""
        ...


Offered = TypeVar("Offered", bound=Offer)


def choose_offer(offers: Sequence[Offered], accept: str | None, asked: str | None) -> Offered:
    """Format of the answer: ``?format=`` first, then ``Accept`` by quality (RFC 9110, 12.5.1).

    Parameters
    ----------
    offers : sequence
        In the order of preference where the caller has none.
    accept : str or None
        The request's header.
    asked : str or None
        Name of one of them.

    Raises
    ------
    Problem
        406, with the formats there are, if none is accepted.
    """
    if asked is not None:
        return next(offer for offer in offers if offer.name == asked)
    wanted = best_offer(accept, [offer.media_type for offer in offers])
    return next(offer for offer in offers if offer.media_type == wanted)
