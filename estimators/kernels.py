"""How compiled code is declared, cached and warmed.

A *kernel* is an entry point into compiled code: it has one explicit signature, releases the GIL, is
compiled (or read from the cache) at its first call or by :func:`warm`, and refuses other types. A
*device* function is compiled into the kernels that call it; *arithmetic* is one that makes no arrays.

Numba stamps a cached kernel with the content of the one file it stands in, so that editing a device
function in another file would leave a stale kernel behind. Here the stamp is the content of that file
and of all it imports from the package, and the cache may live on a read-only disk. A process that
imported a file before it was edited runs the old text, and must not cache it under the new stamp: it
compiles for itself alone.
"""

from __future__ import annotations

import functools
import hashlib
import os
import re
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, Generic, ParamSpec, TypeVar, cast

import numba
from numba.core.caching import CompileResultCacheImpl, FunctionCache, NullCache, UserProvidedCacheLocator

P = ParamSpec("P")
R = TypeVar("R")

_PACKAGE = Path(__file__).resolve().parent
_REGISTRY: list[Kernel[..., Any]] = []
_STARTED_NS = time.time_ns()


def cache_directory() -> Path:
    """Directory of the compiled kernels.

    ``PLUMBLINE_CACHE_DIR`` if set, else inside the package, else the user's cache.

    Returns
    -------
    pathlib.Path
        Not created by this call.
    """
    named = os.environ.get("PLUMBLINE_CACHE_DIR")
    if named:
        return Path(named)
    inside = _PACKAGE / "__pycache__"
    if os.access(inside if inside.exists() else _PACKAGE, os.W_OK):
        return inside
    return Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "plumbline"


_IMPORT = re.compile(r"^from (estimators[\w.]*) import (\([^)]*\)|.*)", re.MULTILINE)


@functools.cache
def source_stamp(path: Path) -> str:
    """Digest of a source file and of everything of the package that it imports, directly or not."""
    digest = hashlib.sha256()
    for source in _sources(path):
        digest.update(str(source.relative_to(_PACKAGE)).encode())
        digest.update(source.read_bytes())
    return digest.hexdigest()


def edited_since_start(path: Path) -> bool:
    """Whether a source file, or one that it imports, was written after this process began to import."""
    return any(source.stat().st_mtime_ns > _STARTED_NS for source in _sources(path))


@functools.cache
def _sources(path: Path) -> tuple[Path, ...]:
    seen: set[Path] = set()
    pending = [path]
    while pending:
        source = pending.pop()
        if source not in seen:
            seen.add(source)
            pending.extend(_imported(source))
    return tuple(sorted(seen))


@functools.cache
def _imported(path: Path) -> tuple[Path, ...]:
    """Files of the package that a file imports; packages count by the modules named, not as a whole."""
    found: list[Path] = []
    for module, names in _IMPORT.findall(path.read_text(encoding="utf-8")):
        base = _PACKAGE.joinpath(*module.split(".")[1:])
        candidates = [base.with_suffix(".py")]
        candidates += [base / f"{name}.py" for name in re.findall(r"\w+", names)]
        found += [candidate for candidate in candidates if candidate.is_file()]
    return tuple(found)


class _Locator(UserProvidedCacheLocator):
    """Place and stamp of a cached kernel; writing is allowed to fail (read-only images)."""

    def __init__(self, py_func: Callable[..., object], py_file: str) -> None:
        self._py_file = py_file
        self._lineno = py_func.__code__.co_firstlineno

    def get_cache_path(self) -> str:
        return str(cache_directory())

    def get_source_stamp(self) -> str:
        return source_stamp(Path(self._py_file).resolve())

    def get_disambiguator(self) -> str:
        relative = Path(self._py_file).resolve().relative_to(_PACKAGE)
        return f"{relative.with_suffix('').as_posix().replace('/', '.')}-{self._lineno}"

    def ensure_cache_path(self) -> None:
        try:
            cache_directory().mkdir(parents=True, exist_ok=True)
        except OSError:
            return

    @classmethod
    def from_function(cls, py_func: Callable[..., object], py_file: str) -> _Locator:
        return cls(py_func, py_file)


class _CacheImpl(CompileResultCacheImpl):
    _locator_classes: list[type[object]] = [_Locator]  # noqa: RUF012  # an instance variable in numba


class _Cache(FunctionCache):
    _impl_class = _CacheImpl


class Kernel(Generic[P, R]):
    """One compiled entry point. Call it like the function it wraps.

    Parameters
    ----------
    function : callable
        The Python source of the kernel, in numba's subset.
    signature : str
        Numba signature; arrays that are only read should be declared read-only by :func:`ro`.
    """

    def __init__(self, function: Callable[P, R], signature: object) -> None:
        functools.update_wrapper(self, function)
        self.name = f"{function.__module__}.{function.__name__}"
        self._signature = signature
        self._dispatcher: Any = numba.njit(nogil=True)(function)
        self._compiled: Callable[P, R] | None = None
        self._loading = threading.Lock()

    def __call__(self, *args: P.args, **kwargs: P.kwargs) -> R:
        """Run the compiled code, loading it at the first call."""
        return (self._compiled or self.load())(*args, **kwargs)

    def load(self) -> Callable[P, R]:
        """Compile the kernel or read it from the cache; later calls cost nothing."""
        # A fit may come while another thread warms: the second waits for the first.
        with self._loading:
            if self._compiled is None:
                dispatcher = self._dispatcher
                stale = edited_since_start(Path(dispatcher.py_func.__code__.co_filename).resolve())
                try:
                    dispatcher._cache = NullCache() if stale else cast("Any", _Cache)(dispatcher.py_func)
                    dispatcher.compile(self._signature)
                except OSError:
                    # A cache that can be neither written nor read must not keep anybody from an answer.
                    dispatcher._cache = NullCache()
                    dispatcher.compile(self._signature)
                dispatcher.disable_compile()
                self._compiled = cast("Callable[P, R]", dispatcher)
            return self._compiled

    @property
    def is_loaded(self) -> bool:
        """Whether the kernel can run without compiling."""
        return self._compiled is not None

    @property
    def came_from_cache(self) -> bool:
        """Whether loading read the compiled code from disk."""
        return bool(self._compiled is not None and sum(self._dispatcher.stats.cache_hits.values()))


def kernel(signature: object) -> Callable[[Callable[P, R]], Kernel[P, R]]:
    """Declare a compiled entry point with one explicit signature."""

    def declare(function: Callable[P, R]) -> Kernel[P, R]:
        declared = Kernel(function, signature)
        _REGISTRY.append(declared)
        return declared

    return declare


def device(function: Callable[P, R]) -> Callable[P, R]:
    """Declare a function that compiled code may call; it is compiled into its callers."""
    return cast("Callable[P, R]", numba.njit(nogil=True)(function))


def arithmetic(function: Callable[P, R]) -> Callable[P, R]:
    """Declare a :func:`device` that makes no arrays or views, and divides as IEEE 754 does.

    It borrows the arrays that it is given: counting references to them costs more than a short function does.
    """
    options: dict[str, Any] = {"nogil": True, "error_model": "numpy", "_nrt": False}
    return cast("Callable[P, R]", numba.njit(**options)(function))


def ro(dtype: Any, ndim: int = 1) -> Any:
    """Numba type of a contiguous array that the kernel only reads."""
    return numba.types.Array(dtype, ndim, "C", readonly=True)


def warm() -> Iterator[tuple[int, int, str]]:
    """Load every declared kernel, one per step.

    Yields
    ------
    tuple of (int, int, str)
        Kernels loaded so far, kernels in all, name of the one just loaded.
    """
    total = len(_REGISTRY)
    for done, entry in enumerate(_REGISTRY, start=1):
        entry.load()
        yield done, total, entry.name


def declared() -> tuple[str, ...]:
    """Names of the kernels declared so far."""
    return tuple(entry.name for entry in _REGISTRY)


def is_warm() -> bool:
    """Whether every declared kernel is loaded."""
    return all(entry.is_loaded for entry in _REGISTRY)
