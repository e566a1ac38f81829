"""Many series in one body: long-form tables in, one row per series out, one file per format."""
