import subprocess
import sys
import tomllib
from importlib.metadata import packages_distributions

from packaging.utils import canonicalize_name

import estimators
from tests.project.closure import direct_requirements
from tests.project.tree import ROOT


def test_the_version_is_the_one_in_pyproject() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    assert estimators.__version__ == project["version"]


def test_every_exported_name_exists_and_the_list_is_sorted() -> None:
    assert list(estimators.__all__) == sorted(estimators.__all__)
    assert [name for name in estimators.__all__ if not hasattr(estimators, name)] == []


def test_importing_the_library_loads_nothing_that_only_an_extra_installs() -> None:
    core = {"numpy", "scipy", "numba"}
    extras = {canonicalize_name(item.name) for item in direct_requirements()} - core
    code = "import sys, estimators; print(*{name.partition('.')[0] for name in sys.modules})"
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    owners = packages_distributions()
    loaded = {canonicalize_name(owner) for name in done.stdout.split() for owner in owners.get(name, ())}
    assert "numpy" in loaded
    assert loaded & extras == set()


def test_the_changelog_names_the_version() -> None:
    assert f"## {estimators.__version__}" in (ROOT / "CHANGELOG.md").read_text()
