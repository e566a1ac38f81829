"""Where minimal samples come from: one file per method, bound to data by :mod:`.draws`."""
