"""Everything that `pip install .[bench]` brings: what ``constraints.txt`` has to pin.

``python -m tests.project.closure --write`` pins the versions that are installed now. Names and versions
only: where packages come from is the business of the machine's own pip configuration.
"""

from __future__ import annotations

import sys
import tomllib
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).resolve().parents[2]
CONSTRAINTS = ROOT / "constraints.txt"
HEADER = """\
# Exact versions of everything that the service, the tests and the benchmarks need.
# Rewritten by `make constraints` from the versions installed in .venv.
"""


def direct_requirements() -> list[Requirement]:
    """Requirements written in ``pyproject.toml``, those of all extras included."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    written = list(project["dependencies"])
    for extra in project["optional-dependencies"].values():
        written.extend(extra)
    requirements = [Requirement(text) for text in written]
    return [item for item in requirements if canonicalize_name(item.name) != "plumbline"]


def closure() -> dict[str, str]:
    """Version of every installed package that a direct requirement leads to, by canonical name.

    Raises
    ------
    PackageNotFoundError
        If a direct requirement is not installed.
    """
    versions: dict[str, str] = {}
    seen: set[tuple[str, str]] = set()
    waiting = direct_requirements()
    direct = {canonicalize_name(item.name) for item in waiting}
    while waiting:
        requirement = waiting.pop()
        name = canonicalize_name(requirement.name)
        try:
            found = distribution(name)
        except PackageNotFoundError:
            if name in direct:
                raise
            continue
        versions[name] = found.version
        for extra in ("", *requirement.extras):
            if (name, extra) in seen:
                continue
            seen.add((name, extra))
            for text in found.requires or ():
                needed = Requirement(text)
                if needed.marker is None or needed.marker.evaluate({"extra": extra}):
                    waiting.append(needed)
    return dict(sorted(versions.items()))


def pinned() -> dict[str, str]:
    """Versions in ``constraints.txt``, by canonical name."""
    lines = [line.split("#")[0].strip() for line in CONSTRAINTS.read_text().splitlines()]
    pairs = [line.split("==") for line in lines if line]
    return {canonicalize_name(name): version for name, version in pairs}


def main() -> None:
    """Print the constraints, or write the file with ``--write``."""
    text = HEADER + "".join(f"{name}=={version}\n" for name, version in closure().items())
    if "--write" in sys.argv[1:]:
        CONSTRAINTS.write_text(text)
    else:
        print(text, end="")


if __name__ == "__main__":
    main()
