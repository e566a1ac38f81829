"""What can be said of the image from its recipe alone."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
import yaml  # comes with schemathesis

from tests.external import require_program
from tests.image.build import INGREDIENTS
from tests.project.tree import ROOT

DOCKERFILE = (ROOT / "Dockerfile").read_text()


@pytest.fixture(scope="module")
def compose() -> dict[str, Any]:
    """The one service of compose.yaml."""
    services = yaml.safe_load((ROOT / "compose.yaml").read_text())["services"]
    (only,) = services.values()
    return dict(only)


def test_hadolint_finds_nothing_with_all_of_its_rules() -> None:
    hadolint = Path(sys.executable).with_name("hadolint")
    done = subprocess.run([hadolint, ROOT / "Dockerfile"], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout + done.stderr) == (0, "")
    assert "hadolint ignore" not in DOCKERFILE


@pytest.mark.parametrize(("engine", "options"), [("docker", ""), ("podman", "--format=docker ")])
def test_make_builds_with_the_program_that_is_there_and_keeps_the_health_check(
    tmp_path: Path, engine: str, options: str
) -> None:
    program = tmp_path / engine
    program.write_text('#!/bin/sh\necho "$0 $*"\n')
    program.chmod(0o755)
    make = [require_program("make"), "image", "BASE=mine:1"]
    done = subprocess.run(
        make, cwd=ROOT, env={"PATH": str(tmp_path)}, capture_output=True, text=True, check=True
    )
    assert done.stdout.split() == f"{program} build {options}--build-arg BASE=mine:1 -t plumbline .".split()


def test_make_says_what_is_missing_to_build_an_image(tmp_path: Path) -> None:
    make = [require_program("make"), "image"]
    done = subprocess.run(
        make, cwd=ROOT, env={"PATH": str(tmp_path)}, capture_output=True, text=True, check=False
    )
    assert done.returncode != 0
    assert "No docker, podman or buildah was found" in done.stderr


def test_the_user_of_the_image_is_a_number_and_not_root() -> None:
    (user,) = re.findall(r"^USER (.*)$", DOCKERFILE, re.MULTILINE)
    assert re.fullmatch(r"[1-9]\d*:[1-9]\d*", user)


def test_the_context_holds_what_the_image_is_made_of_and_nothing_else() -> None:
    lines = (ROOT / ".dockerignore").read_text().splitlines()
    assert "*" in lines
    let_in = {line[1:].split("/")[0] for line in lines if line.startswith("!")}
    assert let_in | {"Dockerfile", ".dockerignore"} == set(INGREDIENTS)


def test_every_stage_starts_from_the_base_that_the_builder_names() -> None:
    assert set(re.findall(r"^FROM (\S+)", DOCKERFILE, re.MULTILINE)) == {"${BASE}"}


def test_compose_gives_the_service_no_more_than_it_needs(compose: dict[str, Any]) -> None:
    assert compose["read_only"] is True
    assert compose["cap_drop"] == ["ALL"]
    assert compose["security_opt"] == ["no-new-privileges:true"]
    assert [mount.split(":")[0] for mount in compose["tmpfs"]] == ["/tmp"]
    assert compose["mem_limit"]
    assert not {"privileged", "cap_add", "network_mode", "volumes"} & compose.keys()


def test_compose_lets_other_machines_in_only_through_a_proxy(compose: dict[str, Any]) -> None:
    assert [port for port in compose["ports"] if not port.startswith("127.0.0.1:")] == []


def test_compose_does_not_start_without_a_key(compose: dict[str, Any]) -> None:
    assert compose["environment"]["PLUMBLINE_API_KEYS"].startswith("${PLUMBLINE_API_KEYS:?")


def test_compose_asks_for_health_as_the_image_does(compose: dict[str, Any]) -> None:
    (program,) = compose["healthcheck"]["test"][2:]
    assert f'CMD ["python", "{program}"]' in DOCKERFILE
    assert (ROOT / "deploy" / Path(program).name).is_file()


def test_compose_and_the_image_name_the_same_base(compose: dict[str, Any]) -> None:
    (base,) = re.findall(r"^ARG BASE=(\S+)$", DOCKERFILE, re.MULTILINE)
    assert compose["build"]["args"]["BASE"] == f"${{BASE:-{base}}}"
