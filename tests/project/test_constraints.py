import re

from packaging.utils import canonicalize_name

from tests.project.closure import CONSTRAINTS, closure, direct_requirements, pinned

LINE = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]*==[0-9][A-Za-z0-9.!+]*")


def test_constraints_hold_names_and_versions_and_nothing_else() -> None:
    lines = CONSTRAINTS.read_text().splitlines()
    written = [line for line in lines if line and not line.startswith("#")]
    assert [line for line in written if not LINE.fullmatch(line)] == []


def test_no_host_name_stands_in_the_constraints() -> None:
    text = CONSTRAINTS.read_text()
    assert re.findall(r"https?:|file:|\b[\w-]+\.(?:org|com|io|net|dev|local)\b", text) == []


def test_every_requirement_of_pyproject_is_pinned_to_a_version_it_allows() -> None:
    versions = pinned()
    for requirement in direct_requirements():
        version = versions.get(canonicalize_name(requirement.name))
        assert version is not None, f"{requirement.name} is not pinned: run `make constraints`"
        assert requirement.specifier.contains(version), f"{requirement} does not allow {version}"


def test_what_is_installed_is_what_the_constraints_pin() -> None:
    versions = pinned()
    different = {name: version for name, version in closure().items() if versions.get(name) != version}
    assert different == {}, "run `make test`, or `make constraints` after an upgrade"
