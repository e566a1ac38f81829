"""Many series at once: slices of series go through compiled code together, to the bits of one by one."""
