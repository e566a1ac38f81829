"""Fenced blocks of a Markdown document: which are run, and which stand for their output.

A ``python``, ``console`` or ``bash`` block is run. A ``text``, ``json`` or ``csv`` block that directly
follows a ``python`` or ``bash`` block is its output; in a ``console`` block the output stands below each
command.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
RUN = frozenset({"python", "console", "bash"})
OUTPUT = frozenset({"text", "json", "csv"})

_FENCE = re.compile(r"^```(?P<language>[\w-]*)\s*$")


@dataclass(frozen=True, slots=True)
class Block:
    """One fenced block; ``first`` and ``last`` are the indices of its first and past-the-last body line."""

    language: str
    lines: tuple[str, ...]
    first: int
    last: int

    @property
    def text(self) -> str:
        return "\n".join(self.lines)


@dataclass(frozen=True, slots=True)
class Example:
    """A block to run and the block that shows what it prints, if any."""

    code: Block
    output: Block | None


def documents() -> list[Path]:
    """Every page whose examples are run. The benchmark pages are written by the benchmark itself."""
    pages = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").glob("*.md"))]
    return [page for page in pages if not page.name.startswith("benchmarks")]


def parse_blocks(lines: Sequence[str]) -> list[Block]:
    """All fenced blocks, in order.

    Raises
    ------
    ValueError
        If a fence is not closed.
    """
    blocks: list[Block] = []
    start: int | None = None
    language = ""
    for index, line in enumerate(lines):
        fence = _FENCE.match(line)
        if fence is None:
            continue
        if start is None:
            start, language = index + 1, fence["language"]
        else:
            blocks.append(Block(language, tuple(lines[start:index]), start, index))
            start = None
    if start is not None:
        raise ValueError(f"the block that begins on line {start} is not closed")
    return blocks


def parse_examples(lines: Sequence[str]) -> list[Example]:
    """Blocks that are run, each with the output block that directly follows it."""
    blocks = parse_blocks(lines)
    followers = [*blocks[1:], None]
    examples = []
    for block, follower in zip(blocks, followers, strict=True):
        if block.language not in RUN:
            continue
        shows_output = (
            follower is not None
            and block.language != "console"
            and follower.language in OUTPUT
            and not any(line.strip() for line in lines[block.last + 1 : follower.first - 1])
        )
        examples.append(Example(block, follower if shows_output else None))
    return examples


@dataclass(frozen=True, slots=True)
class Command:
    """A command of a ``console`` block and what the document says it prints."""

    text: str
    expected: str


def parse_console(block: Block) -> list[Command]:
    """Commands of a ``console`` block: lines after ``$``, continued by a final backslash."""
    commands: list[Command] = []
    command: list[str] = []
    expected: list[str] = []
    reading_command = False
    for line in block.lines:
        if line.startswith("$ "):
            if command:
                commands.append(Command("\n".join(command), "\n".join(expected)))
            command, expected = [line[2:]], []
            reading_command = line.endswith("\\")
        elif reading_command:
            command.append(line)
            reading_command = line.endswith("\\")
        else:
            expected.append(line)
    if command:
        commands.append(Command("\n".join(command), "\n".join(expected)))
    return commands
