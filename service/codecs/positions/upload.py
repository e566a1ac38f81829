"""Files by upload: ``multipart/form-data`` (RFC 7578) with the parts ``observations`` and ``navigation``.

The body is in memory already and bounded there; parts are cut out of it without temporary files, by the
parser that the framework itself uses.
"""

from __future__ import annotations

from python_multipart.exceptions import FormParserError
from python_multipart.multipart import MultipartParser, parse_options_header

from service.codecs.positions.columns import Recording, Sent, validated
from service.errors import Problem, ProblemType, invalid_value
from service.schemas.positions import RecordingArguments

OBSERVATIONS, NAVIGATION = "observations", "navigation"

#: A year of daily navigation files is no request.
MOST_PARTS = 64

#: Bytes that are parsed between one look at the caller and the next.
_PIECE = 2**18
_DISPOSITION = b"content-disposition"


def read_upload(sent: Sent) -> tuple[Recording, RecordingArguments]:
    """Files and arguments of an upload; the arguments come from the query string.

    Raises
    ------
    Problem
        If the body is no multipart/form-data, or a part is missing, unknown or empty.
    """
    arguments = validated(RecordingArguments, sent.query.arguments())
    files: dict[str, list[bytes]] = {OBSERVATIONS: [], NAVIGATION: []}
    for name, content in _parts(sent):
        if name not in files:
            raise invalid_value(
                name[:60] or "body", f"this part is not taken; send {OBSERVATIONS} and {NAVIGATION}"
            )
        files[name].append(content)
    if len(files[OBSERVATIONS]) != 1:
        found = "is missing" if not files[OBSERVATIONS] else "comes twice"
        raise invalid_value(OBSERVATIONS, f"{found}; send one part of this name, a RINEX file or a log")
    if not files[NAVIGATION]:
        raise invalid_value(
            NAVIGATION, "is missing; send the broadcast messages of the days observed as RINEX in this part"
        )
    return Recording(files[OBSERVATIONS][0], files[NAVIGATION]), arguments


def _parts(sent: Sent) -> list[tuple[str, bytes]]:
    """Names and contents of the parts."""
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
    return [(name, bytes(content)) for name, content in zip(parts.names, parts.contents, strict=True)]


class _Parts:
    """Takes what the parser finds."""

    def __init__(self) -> None:
        self.names: list[str] = []
        self.contents: list[bytearray] = []
        self.is_complete = False
        self._field = b""
        self._value = b""

    def begin(self) -> None:
        if len(self.names) == MOST_PARTS:
            raise invalid_value("body", f"more than {MOST_PARTS} parts; send fewer navigation files")
        self.names.append("")
        self.contents.append(bytearray())

    def field(self, data: bytes, start: int, end: int) -> None:
        self._field += data[start:end]

    def value(self, data: bytes, start: int, end: int) -> None:
        self._value += data[start:end]

    def end_header(self) -> None:
        if self._field.lower() == _DISPOSITION:
            name = parse_options_header(self._value.decode("latin-1"))[1].get(b"name", b"")
            self.names[-1] = name.decode("latin-1")
        self._field = self._value = b""

    def data(self, data: bytes, start: int, end: int) -> None:
        self.contents[-1] += data[start:end]

    def end(self) -> None:
        self.is_complete = True
