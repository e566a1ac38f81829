import os
import shutil
import subprocess
from pathlib import Path

import pytest

from tests.external import require_program
from tests.project.tree import ROOT


def run_make(*arguments: str, directory: Path = ROOT, **environment: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [require_program("make"), *arguments],
        cwd=directory,
        env={"PATH": os.environ["PATH"], **environment},
        capture_output=True,
        text=True,
        check=False,
    )


def put_program(directory: Path, name: str, script: str) -> None:
    program = directory / name
    program.write_text(f"#!/bin/sh\n{script}\n")
    program.chmod(0o755)


def test_help_is_the_default_and_names_both_commands_of_the_readme() -> None:
    shown = run_make().stdout
    assert "make serve" in shown
    assert "make test" in shown


def test_the_host_of_the_shell_does_not_decide_where_the_service_listens() -> None:
    shown = run_make("-n", "serve", HOST="workstation.example", PORT="9").stdout
    assert "plumbline serve" in shown
    assert "workstation.example" not in shown


def test_serve_passes_on_the_address_asked_for() -> None:
    shown = run_make("-n", "serve", "HOST=0.0.0.0", "PORT=9000").stdout
    assert '--host "0.0.0.0" --port "9000"' in shown


def test_without_a_python_that_is_new_enough_make_says_so(tmp_path: Path) -> None:
    shutil.copy(ROOT / "Makefile", tmp_path)
    programs = tmp_path / "programs"
    programs.mkdir()
    put_program(programs, "python3", "exit 1")
    done = run_make(".venv/bin/python", directory=tmp_path, PATH=str(programs))
    assert done.returncode != 0
    assert "needs Python 3.11 or newer" in done.stderr


def test_make_prefers_the_python_it_is_told_to_use(tmp_path: Path) -> None:
    shutil.copy(ROOT / "Makefile", tmp_path)
    chosen = tmp_path / "programs with a space"
    chosen.mkdir()
    put_program(chosen, "mine", 'echo "called with $*" >> calls; exit 0')
    done = run_make(".venv/bin/python", f"PYTHON={chosen / 'mine'}", directory=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "called with -m venv .venv" in (tmp_path / "calls").read_text()


@pytest.mark.parametrize("ci", ["", "false"])
def test_ci_runs_exactly_make_test_with_ci_set(tmp_path: Path, ci: str) -> None:
    bash = require_program("bash")
    put_program(tmp_path, "make", 'echo "make $* in $PWD, CI=$CI"')
    done = subprocess.run(
        [bash, str(ROOT / ".ci" / "run")],
        cwd=tmp_path,
        env={"PATH": f"{tmp_path}{os.pathsep}{os.environ['PATH']}", "CI": ci},
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout == f"make test in {ROOT}, CI=true\n"
