import json
import re
import subprocess
from pathlib import Path

import pytest

from tests.docs.blocks import OUTPUT, ROOT, RUN, documents, parse_blocks, parse_examples
from tests.docs.session import open_session
from tests.docs.tables import with_tables
from tests.external import require_program

PAGES = [pytest.param(page, id=page.relative_to(ROOT).as_posix()) for page in documents()]
LINK = re.compile(r"""\]\((?P<to>[^)#\s]+)(?:#[^)]*)?\)|(?:src|srcset|href)="(?P<source>[^"#]+)\"""")


@pytest.mark.parametrize("page", PAGES)
def test_every_example_of_the_page_works_and_prints_what_the_page_shows(page: Path, tmp_path: Path) -> None:
    text = page.read_text()
    for name in ("bash", "curl", "make"):
        if name in text:
            require_program(name)
    problems: list[str] = []
    with open_session(tmp_path) as session:
        for example in parse_examples(text.split("\n")):
            outcome = session.run(page, example)
            problems += outcome.failures + outcome.differences
    assert problems == [], "`make docs` rewrites the outputs"


def test_the_curl_line_that_the_service_prints_works_when_pasted(tmp_path: Path) -> None:
    require_program("curl")
    with open_session(tmp_path) as session:
        (line,) = [line for line in session.announcement().splitlines() if line.strip().startswith("curl ")]
        printed = subprocess.run(["bash", "-c", line], capture_output=True, text=True, check=True).stdout
    assert json.loads(printed)["parameters"]["slope"]["value"] == pytest.approx(2.0, abs=0.1)


@pytest.mark.parametrize("page", PAGES)
def test_the_generated_tables_of_the_page_are_current(page: Path) -> None:
    text = page.read_text()
    assert with_tables(text) == text, "`make docs` rewrites the tables"


@pytest.mark.parametrize("page", PAGES)
def test_no_block_of_the_page_escapes_the_examples_runner(page: Path) -> None:
    blocks = parse_blocks(page.read_text().split("\n"))
    shown = {
        example.output.first for example in parse_examples(page.read_text().split("\n")) if example.output
    }
    astray = [
        (block.first + 1, block.language)
        for block in blocks
        if block.language not in RUN and not (block.language in OUTPUT and block.first in shown)
    ]
    assert astray == []


@pytest.mark.parametrize("page", PAGES)
def test_every_relative_link_of_the_page_leads_to_a_file(page: Path) -> None:
    targets = [match["to"] or match["source"] for match in LINK.finditer(page.read_text())]
    local = [target for target in targets if not re.match(r"[a-z]+:", target)]
    assert [target for target in local if not (page.parent / target).exists()] == []


@pytest.mark.parametrize("page", PAGES)
def test_every_file_that_the_page_names_exists(page: Path) -> None:
    # `estimators/trends/trend.py` and `docs/` are files of the project, `/v1/trends` and `a/b` are not.
    homes = "estimators|service|tests|benchmarks|examples|docs|openapi"
    named = re.findall(rf"`((?:{homes})/[\w./-]*)`", page.read_text())
    assert [name for name in named if not (ROOT / name).exists()] == []
