import os
import re

import pytest

from tests.project.tree import ROOT, project_files, text_files

LONG_MODULES: dict[str, str] = {}
"""Modules over the limit, each with the reason why it is not two modules."""

LINE_LIMIT = 350

# Each pattern is written so that it does not match itself here.
MACHINE_PATHS = re.compile(r"(?<![\w.$}])/(?:work|root|home|Users|opt)/[\w.-]+|[C]:\\\\Users")
REGISTRY_HOSTS = re.compile(
    r"p[y]pi\.org|p[y]thonhosted\.org|n[p]mjs\.(?:org|com)|c[r]ates\.io|r[u]bygems\.org|q[u]ay\.io|g[h]cr\.io"
    r"|d[o]cker\.(?:io|com)|p[r]oxy\.golang\.org|a[n]aconda\.org"
)
INDEX_OPTIONS = re.compile(r"--(?:extra-)?i[n]dex-url|--t[r]usted-host")


def matches(pattern: re.Pattern[str]) -> list[str]:
    return [
        f"{path}:{number}: {line.strip()[:100]}"
        for path, text in text_files()
        if pattern.search(text)
        for number, line in enumerate(text.splitlines(), start=1)
        if pattern.search(line)
    ]


def test_no_file_names_a_path_of_somebody_s_machine() -> None:
    assert matches(MACHINE_PATHS) == []


def test_no_file_names_the_host_of_a_package_registry() -> None:
    assert matches(REGISTRY_HOSTS) == []


def test_packages_come_from_where_the_machine_s_own_configuration_says() -> None:
    assert matches(INDEX_OPTIONS) == []


def test_no_file_holds_a_conflict_marker_or_a_tab_in_python() -> None:
    found = [
        path
        for path, text in text_files()
        if re.search(r"^(?:<{7}|>{7}) ", text, re.MULTILINE) or (path.endswith(".py") and "\t" in text)
    ]
    assert found == []


def test_every_text_file_ends_with_one_newline() -> None:
    found = [
        path
        for path, text in text_files()
        if text and (not text.endswith("\n") or text.endswith("\n\n")) and not path.endswith((".svg", ".dat"))
    ]
    assert found == []


def test_a_module_is_read_in_one_sitting() -> None:
    lengths = {path: text.count("\n") for path, text in text_files() if path.endswith(".py")}
    too_long = {path for path, length in lengths.items() if length > LINE_LIMIT}
    assert too_long == set(LONG_MODULES), "split the module, or list it with its reason"


def test_no_module_is_a_drawer_for_everything() -> None:
    drawers = {"utils", "util", "helpers", "common", "misc", "manager"}
    found = [path for path in project_files() if path.suffix == ".py" and path.stem in drawers]
    assert found == []


@pytest.mark.parametrize("name", ["LICENSE", "CHANGELOG.md", "CONTRIBUTING.md", "README.md", ".ci/run"])
def test_what_a_newcomer_looks_for_is_there(name: str) -> None:
    assert (ROOT / name).stat().st_size > 0


def test_the_ci_script_can_be_executed() -> None:
    assert os.access(ROOT / ".ci" / "run", os.X_OK)
