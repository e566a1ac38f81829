"""Plumbline beside its peers: the same draws, the same process run, ratios instead of absolute times."""

import os

# Before numpy is loaded, here and in worker processes: one thread for everybody, so that the ratios
# compare methods and not the number of cores.
for _variable in ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS"):
    os.environ.setdefault(_variable, "1")
