"""Makes the image to test: a base from Debian's packages, then ``make image`` on top of it.

Nothing comes from an image registry, and packages come from where the machine's own pip configuration says:
they are fetched first and handed to the build as files. Everything is kept in ``build/image``; an image is
built again only when something that goes into it has changed. ``make clean`` removes it all.
"""

from __future__ import annotations

import fcntl
import hashlib
import shutil
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from tests.external import require_program
from tests.image.container import Image, read_config
from tests.project.tree import ROOT, project_files

WORK = ROOT / "build" / "image"
SUITE = "bookworm"
BASE = f"localhost/plumbline-base:{SUITE}"
IMAGE = "localhost/plumbline-test"

#: What the Dockerfile takes from the project.
INGREDIENTS = (
    "Dockerfile",
    ".dockerignore",
    "pyproject.toml",
    "constraints.txt",
    "README.md",
    "LICENSE",
    "deploy",
    "estimators",
    "service",
)

_PIP_CONFIG = "[global]\nno-index = true\nfind-links = /wheels\n"


@contextmanager
def mounted_image() -> Iterator[Image]:
    """Build the image unless it is there, and mount it for as long as the block lasts."""
    for name in ("buildah", "mmdebstrap", "unshare", "make"):
        require_program(name)
    WORK.mkdir(parents=True, exist_ok=True)
    with (WORK / "lock").open("w") as lock:
        # Two test runs share the store.
        fcntl.flock(lock, fcntl.LOCK_EX)
        image = f"{IMAGE}:{digest()}"
        if not _has(image):
            if not _has(BASE):
                _make_base()
            _fetch_wheels()
            _build(image)
            _remove_others(image)
        config = read_config(_buildah("inspect", "--type", "image", image))
        container = _buildah("from", "--pull-never", image)
    try:
        yield Image(Path(_buildah("mount", container)), config)
    finally:
        _buildah("umount", container)
        _buildah("rm", container)


def digest() -> str:
    """Digest of all that goes into the image."""
    content = hashlib.sha256()
    for path in project_files():
        name = path.relative_to(ROOT)
        if name.parts[0] in INGREDIENTS:
            content.update(name.as_posix().encode() + b"\0" + hashlib.sha256(path.read_bytes()).digest())
    return content.hexdigest()[:16]


def _store() -> tuple[str, ...]:
    return ("--root", str(WORK / "store"), "--runroot", str(WORK / "run"))


def _run(*command: str) -> str:
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    if done.returncode:
        raise RuntimeError(f"{' '.join(command)} ended with {done.returncode}: {done.stdout}{done.stderr}")
    return done.stdout.strip()


def _buildah(*arguments: str) -> str:
    return _run("buildah", *_store(), *arguments)


def _has(image: str) -> bool:
    return image in _buildah("images", "--format", "{{.Name}}:{{.Tag}}").split()


def _make_base() -> None:
    archive = WORK / "base.tar"
    _run("mmdebstrap", "--variant=minbase", "--include=python3,python3-venv", SUITE, str(archive))
    container = _buildah("from", "scratch")
    _buildah("add", "--quiet", container, str(archive), "/")
    _buildah("config", "--env", "LANG=C.UTF-8", container)
    _buildah("commit", "--quiet", "--rm", container, BASE)
    archive.unlink()


def _fetch_wheels() -> None:
    """Fetch the packages for the Python of the base, which need not be that of the tests."""
    container = _buildah("from", "--pull-never", BASE)
    show = "import sys; print('%d.%d' % sys.version_info[:2])"
    version = _buildah("run", "--isolation=chroot", container, "--", "python3", "-c", show)
    _buildah("rm", container)
    for folder in ("project", "wheels"):
        shutil.rmtree(WORK / folder, ignore_errors=True)
    pip = (sys.executable, "-m", "pip", "--quiet", "--disable-pip-version-check")
    _run(*pip, "wheel", "--no-deps", "--wheel-dir", str(WORK / "project"), str(ROOT))
    (project,) = (WORK / "project").glob("plumbline-*.whl")
    _run(
        *(*pip, "download", "--dest", str(WORK / "wheels"), "--only-binary=:all:"),
        *("--python-version", version, "--constraint", "constraints.txt", f"{project}[service,rinex]"),
        "hatchling",
    )
    (WORK / "wheels" / project.name).unlink()


def _build(image: str) -> None:
    config = WORK / "pip.conf"
    config.write_text(_PIP_CONFIG)
    arguments = (
        *(*_store(), "--isolation=chroot", "--pull-never", "--layers"),
        *(f"--secret=id=pip.conf,src={config}", f"--volume={WORK / 'wheels'}:/wheels:ro"),
    )
    _run(
        "make",
        "image",
        "ENGINE=buildah",
        f"BASE={BASE}",
        f"IMAGE={image}",
        f"IMAGE_ARGS={' '.join(arguments)}",
    )


def _remove_others(image: str) -> None:
    """Images of earlier states of the project; the layers of this one stay for the next build."""
    for name in _buildah(
        "images", "--format", "{{.Name}}:{{.Tag}}", "--filter", f"reference={IMAGE}"
    ).split():
        if name != image:
            _run_quietly("rmi", name)
    _run_quietly("rmi", "--prune")


def _run_quietly(*arguments: str) -> None:
    # An image that another test run has mounted stays until the next time.
    subprocess.run(["buildah", *_store(), *arguments], capture_output=True, check=False)
