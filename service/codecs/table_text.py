"""Bytes of a delimited text file to rows of cells, with the line number of each for errors.

Files come from spreadsheets, loggers and R as often as from this service, so the delimiter is found out,
byte-order marks, comments and blank lines are skipped, and what is no text at all is named for what it is.
"""

from __future__ import annotations

import csv
import io
from collections import Counter
from collections.abc import Iterator
from itertools import islice

DELIMITER_NAMES = {"tab": "\t", "\\t": "\t", "space": " ", "comma": ",", "semicolon": ";", "pipe": "|"}

# Tried in this order: a comma may also be a decimal sign, so it yields to the others.
_CANDIDATES = "\t;|,"
_SNIFFED_LINES = 50
_COMMENT = "#"
# Only a line that starts with one of these can be blank or a comment.
_SUSPECT = frozenset("# \t\r\n\v\f")
_NOT_TEXT = {
    b"PK\x03\x04": "a zip archive or an Excel workbook; save the sheet as CSV",
    b"\xd0\xcf\x11\xe0": "an old Excel workbook; save the sheet as CSV",
    b"\x1f\x8b": "compressed with gzip; unpack it first, for example with gunzip -c",
    b"PAR1": "a Parquet file; write it as CSV first",
    b"ARROW1": "an Arrow file; write it as CSV first",
    b"%PDF": "a PDF document; export the table as CSV",
    b"\x89PNG": "a picture; give the table of numbers",
}


class TableError(ValueError):
    """A table that cannot be read; the message says where and how to mend it.

    Parameters
    ----------
    message : str
    line : int, optional
        Line of the file, counted from 1.
    column : str, optional
        Name of the column, or its position where it has none.
    """

    def __init__(self, message: str, *, line: int | None = None, column: str | None = None) -> None:
        places = ([f"line {line}"] if line is not None else []) + ([f"column {column}"] if column else [])
        super().__init__(f"{', '.join(places)}: {message}" if places else message)
        self.line = line
        self.column = column


def decode(body: bytes) -> str:
    """Text of a file: UTF-8 with or without a mark, UTF-16 with one, else Latin-1.

    Raises
    ------
    TableError
        If the file is empty or no text.
    """
    if not body.strip():
        raise TableError("the input is empty; give a table with a time and a value column")
    for magic, what in _NOT_TEXT.items():
        if body.startswith(magic):
            raise TableError(f"the input is {what}")
    if body[:2] in (b"\xff\xfe", b"\xfe\xff"):
        encoding = "utf-16"
    elif b"\0" in body[:65_536]:
        raise TableError("the input is not text; give a table of comma-separated values")
    else:
        encoding = "utf-8-sig"
    try:
        return body.decode(encoding)
    except UnicodeDecodeError as error:
        if encoding == "utf-16":
            raise TableError("the input starts like UTF-16 but is not; save it as UTF-8") from error
        # Numbers are the same in every one-byte encoding; only the letters of a header can come out wrong.
        return body.decode("latin-1")


def numbered_rows(text: str, delimiter: str) -> Iterator[tuple[int, list[str]]]:
    """Rows that hold anything, each with the line it ends in.

    Parameters
    ----------
    text : str
    delimiter : str
        One character; a space stands for any run of blanks.

    Yields
    ------
    tuple of (int, list of str)

    Raises
    ------
    TableError
        If a quoted cell does not end, or a cell is longer than 131 072 characters.
    """
    lines = _Lines(text, squeeze=delimiter == " ")
    rows = csv.reader(lines, delimiter=delimiter, skipinitialspace=True, strict=True)
    while True:
        try:
            row = next(rows, None)
        except csv.Error as error:
            raise TableError(
                f"cannot be read as a table ({error}); check the quotes", line=lines.number
            ) from error
        if row is None:
            return
        if row:
            yield lines.number, row


class _Lines:
    """Lines without comments and blank ones, and the number of the last one handed out."""

    def __init__(self, text: str, *, squeeze: bool) -> None:
        self._source = io.StringIO(text, newline="")
        self._squeeze = squeeze
        self.number = 0

    def __iter__(self) -> _Lines:
        return self

    def __next__(self) -> str:
        for line in self._source:
            self.number += 1
            if line[0] in _SUSPECT and (line.isspace() or line.lstrip().startswith(_COMMENT)):
                continue
            return " ".join(line.split()) if self._squeeze else line
        raise StopIteration


def find_delimiter(text: str) -> str:
    r"""Delimiter that cuts most of the first lines into the same number of cells, at least two.

    Blanks are taken for one only where nothing else cuts; a table that nothing cuts has one column.

    Examples
    --------
    >>> find_delimiter("2024-01-01;1,5\n2024-01-02;1,75\n")
    ';'
    """
    sample = "".join(islice(_Lines(text, squeeze=False), _SNIFFED_LINES))
    best, best_share = ",", 0.0
    for delimiter in _CANDIDATES + " ":
        if delimiter == " " and best_share > 0.0:
            break
        share = _regularity(sample, delimiter)
        if share > best_share:
            best, best_share = delimiter, share
    return best


def _regularity(sample: str, delimiter: str) -> float:
    """Share of the rows that have the commonest number of cells, if that is two or more."""
    try:
        widths = Counter(len(row) for _, row in numbered_rows(sample, delimiter))
    except TableError:
        return 0.0
    width, rows = widths.most_common(1)[0] if widths else (0, 0)
    return rows / widths.total() if width > 1 else 0.0
