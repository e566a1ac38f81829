"""What ``plumbline clean`` has made before it writes: :class:`Made`."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from estimators import NoFit


@dataclass(frozen=True, slots=True)
class Made:
    """An answer that can be written.

    Attributes
    ----------
    pieces : iterator of bytes
    refused : sequence of (str or None, NoFit)
        Devices without a track in the order in which they first appear, and why.
    has_track : bool
        Whether any device has one.
    """

    pieces: Iterator[bytes]
    refused: Sequence[tuple[str | None, NoFit]]
    has_track: bool
