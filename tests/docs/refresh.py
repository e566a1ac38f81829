"""``python -m tests.docs.refresh``: run every example and write what it prints into the pages.

Generated tables are rewritten too. An example that fails is named and left as it is.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

from tests.docs.blocks import ROOT, documents, parse_examples
from tests.docs.session import open_session
from tests.docs.tables import with_tables


def refresh(page: Path) -> list[str]:
    """Rewrite the tables and outputs of one page; what could not be brought up to date, in words."""
    text = with_tables(page.read_text())
    lines = text.split("\n")
    with tempfile.TemporaryDirectory() as directory, open_session(Path(directory)) as session:
        outcomes = [session.run(page, example) for example in parse_examples(lines)]
    for outcome in reversed(outcomes):
        if outcome.lines is not None and not outcome.failures:
            lines[outcome.first : outcome.last] = outcome.lines
    page.write_text("\n".join(lines))
    return [failure for outcome in outcomes for failure in outcome.failures]


def main() -> int:
    """Refresh the pages named on the command line, or all of them."""
    pages = [Path(name).resolve() for name in sys.argv[1:]] or documents()
    problems: list[str] = []
    for page in pages:
        before = page.read_text()
        problems += refresh(page)
        state = "as it was" if page.read_text() == before else "rewritten"
        print(f"{page.relative_to(ROOT)}: {state}")
    for problem in problems:
        print(problem, file=sys.stderr)
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
