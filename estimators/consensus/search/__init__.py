"""Ways from data to a model: one file per kind of search."""
