"""Methods of labelling a track: one file each, and one row of :mod:`.registry`."""
