"""XML read as a stream of elements, without document types and so without entities: :func:`read_xml`.

A document type declaration is the door of entity bombs and of external entities alike ("billion laughs",
XXE), and no format of tracks has one: it is refused as a whole. Expat, the parser under Python's own
libraries, is driven directly, since a tree of a million points is 2 GB.
"""

from __future__ import annotations

from typing import IO, Protocol
from xml.parsers import expat

from estimators.adapters.tracks.recording import FIELD
from estimators.arrays import InputError

_DEEPEST = 64
"""Levels of nesting; GPX and KML with all their extensions use about ten."""
_LONGEST_TEXT = 1 << 16


class ElementReader(Protocol):
    """What a format does at each element; names come without their namespace."""

    def start(self, name: str, attributes: dict[str, str]) -> None:
        """Open an element."""

    def end(self, name: str, text: str) -> None:
        """Close an element, with the text since the last tag."""


def read_xml(stream: IO[bytes], reader: ElementReader) -> None:
    """Call ``reader`` for each element of a document.

    Parameters
    ----------
    stream : binary file
    reader : ElementReader

    Raises
    ------
    InputError
        If the document is not well-formed, ends too early, or declares a document type.

    Examples
    --------
    >>> import io
    >>> class Times:
    ...     def start(self, name, attributes): ...
    ...     def end(self, name, text):
    ...         print(name, text.strip())
    >>> read_xml(io.BytesIO(b"<g:time>2021-07-28</g:time>"), Times())
    time 2021-07-28
    """
    local: dict[str, str] = {}
    pieces: list[str] = []
    depth = 0

    def start(tag: str, attributes: dict[str, str]) -> None:
        nonlocal depth
        depth += 1
        if depth > _DEEPEST:
            raise InputError(FIELD, f"nests XML elements more than {_DEEPEST} deep")
        pieces.clear()
        reader.start(local.get(tag) or local.setdefault(tag, tag.rpartition(":")[2]), attributes)

    def end(tag: str) -> None:
        nonlocal depth
        depth -= 1
        reader.end(local[tag], "".join(pieces))
        pieces.clear()

    def text(piece: str) -> None:
        # A text is at most a few pieces: expat gathers them up to the size of its buffer.
        if len(pieces) < _LONGEST_TEXT // parser.buffer_size:
            pieces.append(piece)

    def refuse(*_: object) -> None:
        raise InputError(FIELD, "declares a document type (DOCTYPE); delete the declaration and its entities")

    parser = expat.ParserCreate()
    parser.buffer_text = True
    parser.StartElementHandler = start
    parser.EndElementHandler = end
    parser.CharacterDataHandler = text
    parser.StartDoctypeDeclHandler = refuse
    try:
        parser.ParseFile(stream)
    except expat.ExpatError as error:
        raise InputError(
            FIELD, f"is not well-formed XML: {expat.ErrorString(error.code)} in line {error.lineno}"
        ) from error
    except (LookupError, UnicodeError) as error:
        raise InputError(FIELD, "has an unknown XML encoding; save it as UTF-8") from error
