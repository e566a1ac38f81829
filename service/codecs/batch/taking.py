"""What the readers of binary tables need of their caller: which columns, and how much of them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, Protocol

from service.codecs.limits import Limits

Take = Callable[[Mapping[str, Any]], None]
"""Called with the Arrow arrays of a piece of a table, by the roles of their columns."""


class Choice(Protocol):
    """Columns to read and the bounds of reading them."""

    @property
    def limits(self) -> Limits:
        """Most that is read."""
        ...

    @property
    def check(self) -> Callable[[], None]:
        """Called between pieces; raises if nobody waits any more."""
        ...

    def choose(self, header: Sequence[str]) -> dict[str, int]:
        """Places of the columns to read in a header, by their roles; raises if one is not there."""
        ...
