"""The image at work: built by ``make image``, run with a read-only root, another user and no capabilities."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import urllib.error
import urllib.request
from pathlib import Path

import pytest
from packaging.utils import canonicalize_name

from tests.docs.blocks import ROOT, parse_blocks, parse_console
from tests.docs.comparison import difference, tidy
from tests.external import require_program
from tests.image.container import KEY, UID, Image, Service
from tests.project.closure import pinned

pytestmark = pytest.mark.xdist_group("image")

HEALTH = "/app/deploy/check_health.py"


def curl_of_the_readme() -> tuple[str, str]:
    """First command of the README that fits over HTTP, and what the README says it prints."""
    blocks = parse_blocks((ROOT / "README.md").read_text().split("\n"))
    commands = [
        command for block in blocks if block.language == "console" for command in parse_console(block)
    ]
    first = next(command for command in commands if command.text.startswith("curl "))
    return first.text, first.expected


def printed_by(command: str) -> str:
    bash = require_program("bash")
    require_program("curl")
    return subprocess.run([bash, "-c", command], cwd=ROOT, capture_output=True, text=True, check=True).stdout


def ask(service: Service, *, accept: str = "application/json") -> bytes:
    series = {"time": [0, 1, 2, 3, 4, 5, 6, 7], "value": [1.0, 3.1, 4.9, 7.0, 40.0, 11.1, 12.9, 15.0]}
    headers = {"Content-Type": "application/json", "Accept": accept, "Authorization": f"Bearer {KEY}"}
    request = urllib.request.Request(f"{service.url}/v1/trends", json.dumps(series).encode(), headers)
    with urllib.request.urlopen(request, timeout=30) as answer:
        return bytes(answer.read())


def test_without_a_key_the_image_refuses_to_start_and_says_what_to_set(image: Image) -> None:
    done = image.run()
    assert done.returncode == 2
    assert "PLUMBLINE_API_KEYS" in done.stderr


def test_no_kernel_is_compiled_at_the_start(image: Image) -> None:
    done = image.run("/app/deploy/check_kernels.py", entrypoint=["python"])
    assert done.returncode == 0, done.stderr
    assert "none had to be compiled" in done.stdout


def test_a_kernel_that_is_not_in_the_image_is_noticed(image: Image) -> None:
    # Another processor than the one the kernels were compiled for.
    done = image.run("/app/deploy/check_kernels.py", entrypoint=["python"], NUMBA_CPU_NAME="x86-64-v2")
    assert done.returncode == 1
    assert "not in /app/kernels" in done.stderr


def test_the_service_runs_as_another_user_without_capabilities_or_new_privileges(service: Service) -> None:
    status = dict(
        line.split(":\t", 1) for line in Path(f"/proc/{service.pid}/status").read_text().splitlines()
    )
    assert status["Uid"].split() == [str(UID)] * 4
    assert {status[name].strip("0") for name in ("CapInh", "CapPrm", "CapEff", "CapBnd", "CapAmb")} == {""}
    assert status["NoNewPrivs"] == "1"


def test_nothing_but_tmp_can_be_written(image: Image) -> None:
    code = "open('/tmp/a', 'w').close(); open('/app/kernels/a', 'w')"
    assert "Read-only file system: '/app/kernels/a'" in image.run("-c", code, entrypoint=["python"]).stderr


def test_the_curl_of_the_readme_with_a_key_gets_the_answer_of_the_readme(service: Service) -> None:
    command, expected = curl_of_the_readme()
    keyed = command.replace("curl ", f"curl -H 'Authorization: Bearer {KEY}' ", 1)
    printed = printed_by(keyed.replace("127.0.0.1:8000", f"127.0.0.1:{service.port}"))
    assert difference(expected, tidy(printed)) is None


def test_on_the_loopback_interface_the_curl_of_the_readme_works_as_it_stands(image: Image) -> None:
    command, expected = curl_of_the_readme()
    with image.serve(PLUMBLINE_HOST="127.0.0.1") as service:
        printed = printed_by(command.replace("127.0.0.1:8000", f"127.0.0.1:{service.port}"))
    assert difference(expected, tidy(printed)) is None


def test_a_caller_without_the_key_is_turned_away(service: Service) -> None:
    request = urllib.request.Request(f"{service.url}/v1/trends", b"{}", {"Content-Type": "application/json"})
    with pytest.raises(urllib.error.HTTPError) as refused:
        urllib.request.urlopen(request, timeout=30)
    refused.value.close()
    assert refused.value.code == 401


def test_a_picture_is_drawn_though_nothing_but_tmp_can_be_written(service: Service) -> None:
    assert b"<svg" in ask(service, accept="image/svg+xml")


def test_the_health_check_tells_a_service_that_is_ready_from_none(image: Image, service: Service) -> None:
    assert image.config["Healthcheck"]["Test"] == ["CMD", "python", HEALTH]
    while_ready = image.run(HEALTH, entrypoint=["python"], PLUMBLINE_PORT=str(service.port))
    assert (while_ready.returncode, while_ready.stderr) == (0, "")
    # Nobody listens on port 1.
    assert image.run(HEALTH, entrypoint=["python"], PLUMBLINE_PORT="1").returncode == 1


def test_the_stop_signal_of_the_image_ends_the_service_in_peace(image: Image) -> None:
    with image.serve(PLUMBLINE_API_KEYS=KEY) as service:
        os.kill(service.pid, signal.Signals[image.config["StopSignal"]])
        _, said = service.process.communicate(timeout=60)
    assert service.process.returncode == 0
    assert "Traceback" not in said


def test_what_the_service_logs_holds_no_warning(image: Image) -> None:
    with image.serve(PLUMBLINE_API_KEYS=KEY) as service:
        ask(service)
        ask(service, accept="image/png")
        os.kill(service.pid, signal.SIGTERM)
        _, said = service.process.communicate(timeout=60)
    assert re.findall(r".*(?:[Ww]arning|[Ee]rror|Matplotlib).*", said) == []


def test_other_commands_than_serve_take_its_place(image: Image) -> None:
    assert image.run("--version").stdout.startswith("plumbline ")


def test_the_image_holds_the_pinned_versions_and_nothing_to_install_or_build_with(image: Image) -> None:
    (packages,) = (image.root / "app" / "lib").glob("python3.*/site-packages")
    names = (path.name.removesuffix(".dist-info").rsplit("-", 1) for path in packages.glob("*.dist-info"))
    found = {str(canonicalize_name(name)): version for name, version in names}
    del found["plumbline"]
    versions: dict[str, str] = dict(pinned())
    assert {name: version for name, version in found.items() if versions.get(name) != version} == {}
    assert found.keys() & {"pip", "setuptools", "wheel", "hatchling"} == set()


@pytest.mark.parametrize("program", ["gcc", "cc", "make", "curl", "git"])
def test_programs_for_building_are_left_out(image: Image, program: str) -> None:
    places = ("app/bin", "usr/local/bin", "usr/bin", "bin")
    assert [place for place in places if (image.root / place / program).exists()] == []


def test_neither_caches_nor_sources_nor_secrets_of_the_build_are_left(image: Image) -> None:
    home = [path.name for path in (image.root / "root").glob(".cache/*")]
    places = ("build", "etc/pip.conf", "run/secrets")
    assert home + [place for place in places if (image.root / place).exists()] == []
    assert list((image.root / "tmp").iterdir()) == []
