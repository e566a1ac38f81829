"""docs/container.md: its commands, which want an image, are indented and not fenced."""

from __future__ import annotations

import json
import re
import subprocess

import pytest

from service.settings import Settings
from tests.external import require_program
from tests.image.container import KEY, Image, Service
from tests.project.tree import ROOT

pytestmark = pytest.mark.xdist_group("image")

PAGE = (ROOT / "docs" / "container.md").read_text()
COMMANDS = [
    re.sub(r"\\\n\s+", "", block).strip() for block in re.findall(r"^    (?:.+\n)+", PAGE, re.MULTILINE)
]


def the_command(start: str) -> str:
    (command,) = [command for command in COMMANDS if command.startswith(start)]
    return command


def test_the_curl_of_the_page_is_answered(service: Service) -> None:
    require_program("curl")
    command = the_command("curl ").replace("127.0.0.1:8000", f"127.0.0.1:{service.port}")
    done = subprocess.run(
        [require_program("bash"), "-c", command],
        env={"PATH": "/usr/bin:/bin", "PLUMBLINE_API_KEYS": KEY},
        capture_output=True,
        text=True,
        check=True,
    )
    assert json.loads(done.stdout)["parameters"]["slope"]["value"] == pytest.approx(2.0, abs=0.1)


def test_a_table_is_fitted_from_standard_input_as_the_page_shows(image: Image) -> None:
    command = the_command("docker run --rm -i plumbline ")
    arguments, table = command.removeprefix("docker run --rm -i plumbline ").split(" < ")
    done = image.run(*arguments.split(), given=(ROOT / table).read_text())
    assert done.returncode == 0, done.stderr
    assert "Robust trend" in done.stdout


def test_the_check_of_a_host_is_the_one_in_the_image(image: Image) -> None:
    script = the_command("docker run --rm --entrypoint python plumbline ").split()[-1]
    assert (image.root / script.lstrip("/")).is_file()


def test_the_page_runs_the_image_as_strictly_as_compose_does() -> None:
    (command,) = [command for command in COMMANDS if "--name plumbline" in command]
    for option in ("--read-only", "--tmpfs /tmp", "--cap-drop ALL", "--security-opt no-new-privileges"):
        assert option in command
    assert "-p 127.0.0.1:8000:8000" in command


def test_every_setting_that_the_page_names_is_one() -> None:
    known = {f"PLUMBLINE_{name.upper()}" for name in Settings.model_fields}
    assert set(re.findall(r"PLUMBLINE_[A-Z_]+", PAGE)) <= known
