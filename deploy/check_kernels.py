"""Fails if a start in this image would compile anything: the last step of its build, a check on a new host.

``docker run --rm --entrypoint python plumbline /app/deploy/check_kernels.py``
"""

from __future__ import annotations

import sys

from numba.core.event import RecordingListener, install_listener

# Importing the service declares every kernel that it may call.
import service.main  # noqa: F401
from estimators import kernels


def main() -> int:
    """Load every kernel; stop at the first for which numba has to compile something."""
    place = kernels.cache_directory()
    compiled = RecordingListener()  # type: ignore[no-untyped-call]
    done = 0
    with install_listener("numba:compile", compiled):
        for done, total, name in kernels.warm():
            if compiled.buffer:
                print(f"{name}, {done} of {total}, is not in {place}", file=sys.stderr)
                return 1
    print(f"{done} kernels are in {place}, none had to be compiled")
    return 0


if __name__ == "__main__":
    sys.exit(main())
