"""Tables as Arrow IPC, stream or file, read record batch by record batch.

What the messages say they hold is added up before anything is unpacked
(:mod:`service.codecs.batch.arrow_messages`), and every record batch is validated in full before it is looked
at: offsets and indices of a stranger's buffers point wherever they like. A file is a stream with an index
behind it, so both are read as one.
"""

from __future__ import annotations

from typing import Any

import pyarrow as pa

from service.codecs.batch.arrow_messages import sizes_of
from service.codecs.batch.rows import Batch, Gatherer, Reading
from service.codecs.batch.taking import Choice, Take
from service.errors import Problem, ProblemType

MAGIC = b"ARROW1"

#: The magic of a file is padded to so many bytes; its stream starts there.
FILE_HEAD = 8


def read_arrow(source: Any, reading: Reading) -> Batch:
    """Batch of an Arrow IPC stream or file.

    Parameters
    ----------
    source : pyarrow.NativeFile
        Seekable.
    reading : Reading

    Raises
    ------
    Problem
        If the bytes are no Arrow or end too early, a column is not there, or holds what it should not.
    """
    gatherer = Gatherer(reading)
    take_arrow(source, reading, gatherer.add)
    return gatherer.finish()


def take_arrow(source: Any, reading: Choice, take: Take) -> None:
    """Hand over the pieces of an Arrow IPC stream or file, the columns chosen by their roles.

    Parameters
    ----------
    source : pyarrow.NativeFile
        Seekable.
    reading : Choice
    take : callable
        Called with the columns of each piece.

    Raises
    ------
    Problem
        If the bytes are no Arrow or end too early.
    """
    start = FILE_HEAD if source.read(len(MAGIC)) == MAGIC else 0
    try:
        _check_sizes(source, start, reading)
        source.seek(start)
        header = pa.ipc.open_stream(source).schema
        places = reading.choose(header.names)
        options = pa.ipc.IpcReadOptions(included_fields=sorted(places.values()), use_threads=False)
        source.seek(start)
        order = sorted(places, key=lambda role: places[role])
        for piece in pa.ipc.open_stream(source, options=options):
            piece.validate(full=True)
            take(dict(zip(order, piece.columns, strict=True)))
    except (pa.ArrowException, OSError, UnicodeDecodeError):
        raise Problem(
            ProblemType.malformed_body, "the Arrow data are broken or end before they are complete"
        ) from None


def _check_sizes(source: Any, start: int, reading: Choice) -> None:
    """Refuse what would be too much, and a stream that was cut off, from the messages alone."""
    source.seek(start)
    rows = unpacked = 0
    for message in pa.ipc.MessageReader.open_stream(source):
        reading.check()
        found = sizes_of(message)
        rows += found.rows
        unpacked += found.bytes
        reading.limits.check_points(rows)
        reading.limits.check_bytes(unpacked)
