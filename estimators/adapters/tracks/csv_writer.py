"""A cleaned track as CSV (RFC 4180), one row per fix in input order: :func:`write_csv`."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import chain

from estimators.adapters.tracks.cleaned import Cleaned
from estimators.adapters.tracks.recording import Recording
from estimators.adapters.tracks.written_columns import PIECE_ROWS, Column, Layout, Texts, written_columns

_FORMULA = ("=", "+", "-", "@", "\t")


def write_csv(recording: Recording, cleaned: Cleaned | None = None) -> Iterator[bytes]:
    r"""Write a table with a header.

    Parameters
    ----------
    recording : Recording
    cleaned : Cleaned, optional
        Default: the recording as it is.

    Returns
    -------
    iterator of bytes
        Pieces of the file. The columns are those of :func:`written_columns`; an empty cell has no value.

    Raises
    ------
    InputError
        If the two differ in length.

    Examples
    --------
    >>> from estimators.adapters.tracks import read_track
    >>> b"".join(write_csv(read_track(b"t,lat,lon\n0,50,7\n1,95,7\n")))
    b'time,lat,lon\n0,50.0000000,7.0000000\n1,,\n'
    """
    columns = list(written_columns(recording, cleaned).values())
    return chain([_header(columns)], _rows(columns, len(recording)))


def stream_csv(pairs: Iterable[tuple[Recording, Cleaned]], layout: Layout) -> Iterator[bytes]:
    """Write rows as they come with what is said of them, under one header; otherwise as :func:`write_csv`."""
    is_first = True
    for recording, cleaned in pairs:
        columns = list(written_columns(recording, cleaned, layout).values())
        if is_first:
            yield _header(columns)
        is_first = False
        yield from _rows(columns, len(recording))


def _header(columns: list[Column]) -> bytes:
    return (",".join(column.name for column in columns) + "\n").encode()


def _rows(columns: list[Column], n: int) -> Iterator[bytes]:
    for start in range(0, n, PIECE_ROWS):
        part = slice(start, start + PIECE_ROWS)
        cells = [_cells(column, part) for column in columns]
        yield "".join([",".join(row) + "\n" for row in zip(*cells, strict=True)]).encode()


def _cells(column: Column, part: slice) -> list[str]:
    texts: Texts = column.text(part)
    if column.kind != "text" or column.name == "time":
        return [text or "" for text in texts]
    return [_quoted(text or "") for text in texts]


def _quoted(text: str) -> str:
    """Quote a cell of text; an apostrophe keeps spreadsheets from running it as a formula."""
    text = " ".join(text.splitlines())
    if text.startswith(_FORMULA):
        text = "'" + text
    return '"' + text.replace('"', '""') + '"' if any(mark in text for mark in ',"\r\n#') else text
