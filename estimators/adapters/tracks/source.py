"""A file by its content or its path as a stream that cannot grow without bound: :func:`open_track`.

gzip is unpacked on the way. Whatever goes wrong while reading (a damaged archive, too many bytes) is an
``InputError`` at the place of reading, so that no reader of a format has to know of it.
"""

from __future__ import annotations

import gzip
import io
import zipfile
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import IO, TYPE_CHECKING

from estimators.adapters.tracks.recording import FIELD
from estimators.arrays import InputError

if TYPE_CHECKING:
    from _typeshed import WriteableBuffer

Source = bytes | Path
"""A file by its content or by its path."""

MOST_BYTES = 1 << 30
"""Unpacked size that is read: 20 million rows of CSV, eight million points of GPX."""
BUFFER_BYTES = 1 << 16
_UNPACKED = frozenset({zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED})
"""Other methods need memory that the packed size does not bound."""
_GZIP, _ZIP = b"\x1f\x8b", b"PK\x03\x04"


class TooLargeError(InputError):
    """A file is larger than is read; callers that can tell so by a status of its own catch it apart."""


def open_track(
    source: Source, most_bytes: int = MOST_BYTES, check: Callable[[], object] | None = None
) -> io.BufferedReader:
    """Open a file, unpack gzip or the KML of a KMZ archive, and bound what can be read.

    Parameters
    ----------
    source : bytes or Path
    most_bytes : int
        Unpacked size above which reading fails.
    check : callable, optional
        Called before each piece is read; it may raise to end the reading.

    Raises
    ------
    InputError
        If it cannot be opened, is empty, or is an archive without a KML file.

    Examples
    --------
    >>> import gzip
    >>> open_track(gzip.compress(b"time,lat,lon")).read()
    b'time,lat,lon'
    """
    file = _open(source)
    try:
        return io.BufferedReader(_Bounded(file, _unpacked(file), most_bytes, check), BUFFER_BYTES)
    except InputError:
        file.close()
        raise


def _open(source: Source) -> IO[bytes]:
    if isinstance(source, Path):
        try:
            return source.open("rb")
        except OSError as error:
            raise InputError(FIELD, f"cannot be read: {error.strerror or type(error).__name__}") from error
    if not isinstance(source, bytes):
        raise InputError(FIELD, "expected the bytes of a file or a pathlib.Path")
    return io.BytesIO(source)


def _unpacked(file: IO[bytes]) -> IO[bytes] | gzip.GzipFile:
    try:
        magic = file.read(4)
        file.seek(0)
    except OSError as error:
        raise InputError(FIELD, "cannot be read twice; send its bytes") from error
    if not magic:
        raise InputError(FIELD, "is empty")
    if magic == _ZIP:
        return _open_archive(file)
    return gzip.GzipFile(fileobj=file) if magic[:2] == _GZIP else file


def _open_archive(file: IO[bytes]) -> IO[bytes]:
    try:
        archive = zipfile.ZipFile(file)
        # KML 2.2, section 2.2.2: the first .kml file of a KMZ archive is its document.
        member = next((item for item in archive.infolist() if item.filename.lower().endswith(".kml")), None)
        if member is not None and member.compress_type in _UNPACKED:
            return archive.open(member)
    except (zipfile.BadZipFile, RuntimeError, OSError, EOFError, ValueError) as error:
        raise InputError(FIELD, "is a damaged or encrypted archive; send the track itself") from error
    raise InputError(FIELD, "is an archive without a KML file; unpack it and send the track itself")


class _Bounded(io.RawIOBase):
    """A stream that refuses to give more than so many bytes."""

    def __init__(
        self,
        file: IO[bytes],
        raw: IO[bytes] | gzip.GzipFile,
        most_bytes: int,
        check: Callable[[], object] | None,
    ) -> None:
        super().__init__()
        self._file = file
        self._raw = raw
        self._most_bytes = most_bytes
        self._check = check
        self._given = 0

    def readable(self) -> bool:
        return True

    def close(self) -> None:
        if not self.closed:
            self._raw.close()
            self._file.close()
        super().close()

    def readinto(self, buffer: WriteableBuffer, /) -> int:
        if self._check is not None:
            self._check()
        view = memoryview(buffer).cast("B")
        try:
            piece = self._raw.read(len(view))
        except (OSError, EOFError, ValueError, zlib.error, zipfile.BadZipFile) as error:
            raise InputError(FIELD, "is damaged or ends too early; send it again") from error
        self._given += len(piece)
        if self._given > self._most_bytes:
            raise TooLargeError(FIELD, f"has more than {self._most_bytes} bytes; split it by time")
        view[: len(piece)] = piece
        return len(piece)
