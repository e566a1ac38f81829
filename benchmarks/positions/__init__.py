"""``python -m benchmarks.positions``: fault exclusion beside RTKLIB, sidereon and gnss_lib_py."""
