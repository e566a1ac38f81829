"""Parts of ``multipart/form-data`` (RFC 7578).

The body is in memory already and bounded there; parts are cut out of it without temporary files, by the
parser that the framework itself uses.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from python_multipart.exceptions import FormParserError
from python_multipart.multipart import MultipartParser, parse_options_header

from service.codecs.sent import Sent
from service.errors import Problem, ProblemType, invalid_value

#: A year of daily files is no request.
MOST_PARTS = 64

#: Bytes that are parsed between one look at the caller and the next.
_PIECE = 2**18
_DISPOSITION = b"content-disposition"


@dataclass(frozen=True, slots=True)
class Part:
    """A part of a form.

    Attributes
    ----------
    name : str
        Of its field.
    filename : str
        As the caller has it; empty if it was not said.
    content : bytes
    """

    name: str
    filename: str
    content: bytes


def read_parts(sent: Sent[Any]) -> list[Part]:
    """Cut a body into its parts.

    Raises
    ------
    Problem
        400 if they cannot be told apart, 422 if there are too many.
    """
    boundary = parse_options_header(sent.content_type)[1].get(b"boundary", b"")
    if not boundary:
        raise Problem(ProblemType.malformed_body, "Content-Type names no boundary of the parts")
    parts = _Parts()
    try:
        parser = MultipartParser(
            boundary,
            {
                "on_part_begin": parts.begin,
                "on_header_field": parts.field,
                "on_header_value": parts.value,
                "on_header_end": parts.end_header,
                "on_part_data": parts.data,
                "on_end": parts.end,
            },
        )
        for start in range(0, len(sent.content), _PIECE):
            sent.check()
            parser.write(sent.content[start : start + _PIECE])
    except FormParserError:
        raise Problem(ProblemType.malformed_body, "the parts of the body cannot be told apart") from None
    if not parts.is_complete:
        raise Problem(ProblemType.malformed_body, "the body ends before its last part does; send it again")
    told = zip(parts.names, parts.filenames, parts.contents, strict=True)
    return [Part(name, filename, bytes(content)) for name, filename, content in told]


class _Parts:
    """Takes what the parser finds."""

    def __init__(self) -> None:
        self.names: list[str] = []
        self.filenames: list[str] = []
        self.contents: list[bytearray] = []
        self.is_complete = False
        self._field = b""
        self._value = b""

    def begin(self) -> None:
        if len(self.names) == MOST_PARTS:
            raise invalid_value("body", f"more than {MOST_PARTS} parts; send fewer files")
        self.names.append("")
        self.filenames.append("")
        self.contents.append(bytearray())

    def field(self, data: bytes, start: int, end: int) -> None:
        self._field += data[start:end]

    def value(self, data: bytes, start: int, end: int) -> None:
        self._value += data[start:end]

    def end_header(self) -> None:
        if self._field.lower() == _DISPOSITION:
            options = parse_options_header(self._value.decode("latin-1"))[1]
            self.names[-1] = options.get(b"name", b"").decode("latin-1")
            # Browsers and curl send the names of files in UTF-8.
            self.filenames[-1] = options.get(b"filename", b"").decode("utf-8", "replace")
        self._field = self._value = b""

    def data(self, data: bytes, start: int, end: int) -> None:
        self.contents[-1] += data[start:end]

    def end(self) -> None:
        self.is_complete = True
