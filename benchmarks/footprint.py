"""What a fit costs beside its time: the way from a cold process to the first answer, and memory.

Each figure comes from a fresh process. Kernels are compiled once before; what is timed is the start
that every later process has.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.bed import draw_rng, make_series

FITS: Mapping[str, tuple[str, str]] = {
    "Plumbline auto": ("from estimators import fit_trend", "fit_trend(t, y)"),
    "scikit-learn RANSACRegressor": (
        "from sklearn.linear_model import RANSACRegressor",
        "RANSACRegressor(random_state=0).fit(t[:, None], y)",
    ),
    "scikit-image ransac": (
        "from skimage.measure import LineModelND, ransac",
        "ransac(np.column_stack((t, y)), LineModelND, 2, 2.7, rng=0)",
    ),
    "scipy theilslopes": ("from scipy.stats import theilslopes", "theilslopes(y, t)"),
    "statsmodels RLM, Tukey": (
        "import statsmodels.api as sm",
        "sm.RLM(y, sm.add_constant(t), M=sm.robust.norms.TukeyBiweight()).fit()",
    ),
}
"""What each contender imports, and how it fits."""
_MOST_POINTS = {"scipy theilslopes": 10_000}

_START = """
import time; started = time.perf_counter()
import json, sys, numpy as np
loaded = time.perf_counter()
t = np.arange(200.0); y = 0.3 * t + np.sin(1e4 * t)
{imports}
{fit}
print(json.dumps([time.perf_counter() - started, loaded - started]))
"""

_MEMORY = """
import json, os, sys, numpy as np
{imports}
def peak():
    # The kernel's mark of this process alone; getrusage would start from the size of our parent.
    with open("/proc/self/status") as status:
        return next(1024.0 * float(line.split()[1]) for line in status if line.startswith("VmHWM"))
t = np.arange(200.0); y = 0.3 * t + np.sin(1e4 * t)
{fit}
t, y = np.load(sys.argv[1]), np.load(sys.argv[2])
if not os.path.exists("/proc/self/status"):
    print(json.dumps([float("nan")]))
    sys.exit()
before = peak()
{fit}
print(json.dumps([(peak() - before) / (t.nbytes + y.nbytes)]))
"""


@dataclass(frozen=True, slots=True)
class Footprint:
    """Costs of a contender.

    Attributes
    ----------
    start_s : float
        From the start of the interpreter's work to the first answer, median.
    start_in_numpy_imports : float
        The same in imports of numpy, measured in the same processes.
    memory_points : int
        Size at which memory was measured.
    memory_in_data : float
        Peak resident memory beyond that before the fit, in sizes of the data; NaN where nobody can tell.
    """

    start_s: float
    start_in_numpy_imports: float
    memory_points: int
    memory_in_data: float


def measure_footprints(
    names: Iterable[str] = FITS, *, starts: int = 5, points: int = 1_000_000
) -> dict[str, Footprint]:
    """Measure start and memory in fresh processes.

    Parameters
    ----------
    names : iterable of str
        Keys of :data:`FITS`.
    starts : int
        Starts that are timed; the figures are medians.
    points : int
        Size of the series for memory.
    """
    measured = {}
    for name in names:
        imports, fit = FITS[name]
        script = _START.format(imports=imports, fit=fit)
        _run(script)  # fills caches: compiled kernels, bytecode, files
        seconds = np.array([_run(script) for _ in range(starts)])
        n = min(points, _MOST_POINTS.get(name, points))
        measured[name] = Footprint(
            start_s=float(np.median(seconds[:, 0])),
            start_in_numpy_imports=float(np.median(seconds[:, 0] / seconds[:, 1])),
            memory_points=n,
            memory_in_data=_memory(_MEMORY.format(imports=imports, fit=fit), n),
        )
    return measured


def _memory(script: str, n: int) -> float:
    """Peak memory of a fit in sizes of its data, which come from files: making them would leave a peak."""
    draw = make_series("uniform", n, 0.4, draw_rng(0, "uniform", n, 0.4, 0))
    with tempfile.TemporaryDirectory() as folder:
        files = [str(Path(folder, name)) for name in ("t.npy", "y.npy")]
        for file, column in zip(files, (draw.t, draw.y), strict=True):
            np.save(file, column)
        return _run(script, *files)[0]


def _run(script: str, *arguments: str) -> list[float]:
    """Last line that a fresh interpreter prints, read as JSON numbers."""
    command = [sys.executable, "-c", script, *arguments]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    return [float(value) for value in json.loads(done.stdout.splitlines()[-1])]
