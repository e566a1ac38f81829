"""The files of the project: what stands in the repository, without what .gitignore leaves out."""

from __future__ import annotations

import os
from collections.abc import Iterator
from fnmatch import fnmatch
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
_BINARY = (".png", ".gz", ".ico", ".woff2", ".parquet", ".arrow")


def project_files() -> Iterator[Path]:
    """Every file, hidden ones included; works in a copy that is no git repository."""
    patterns = [line.strip() for line in (ROOT / ".gitignore").read_text().splitlines()]
    ignored = [line.rstrip("/") for line in patterns if line and not line.startswith("#")]

    def kept(name: str) -> bool:
        return name != ".git" and not any(fnmatch(name, pattern) for pattern in ignored)

    for directory, folders, files in os.walk(ROOT):
        folders[:] = sorted(name for name in folders if kept(name))
        yield from (Path(directory, name) for name in sorted(files) if kept(name))


def text_files() -> Iterator[tuple[str, str]]:
    """Path relative to the root, and text, of every text file."""
    for path in project_files():
        if path.suffix not in _BINARY:
            yield path.relative_to(ROOT).as_posix(), path.read_text(encoding="utf-8")
