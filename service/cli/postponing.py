"""Modules that a start would import and not use.

SciPy takes every public name out of NumPy (``from numpy import *`` in its array layer), and with them the
tools for Fortran and for tests, which are a tenth of all that a start imports. Here they are put in place
unopened, by the standard library's own means; the first look into one opens it.
"""

from __future__ import annotations

import importlib.util
import sys

UNUSED = ("numpy.f2py", "numpy.testing")


def postpone_imports() -> None:
    """Put unopened modules in the place of those that nobody has imported yet."""
    for name in UNUSED:
        spec = importlib.util.find_spec(name)
        if name in sys.modules or spec is None or spec.loader is None:
            continue
        spec.loader = importlib.util.LazyLoader(spec.loader)
        module = importlib.util.module_from_spec(spec)
        sys.modules[name] = module
        spec.loader.exec_module(module)
        package, _, title = name.rpartition(".")
        setattr(sys.modules[package], title, module)
