"""Formats of answers and how one of them is chosen: ``?format=`` first, then ``Accept``."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

from service.codecs.negotiation import best_offer

Name = TypeVar("Name", bound=str)


@dataclass(frozen=True, slots=True)
class Offer(Generic[Name]):
    """A format of answers; the tables of writers add what writes it.

    Attributes
    ----------
    name : str
        As in ``?format=``.
    media_type, content_type : str
        As in ``Accept``, without parameters, and as in the answer's ``Content-Type``.
    """

    name: Name
    media_type: str
    content_type: str


Offered = TypeVar("Offered", bound=Offer[Any])


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
