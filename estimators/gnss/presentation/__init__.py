"""How a fix leaves Python: dict, GeoJSON, data frame and text."""
