"""How a track leaves Python: dict, GeoJSON, data frame and text."""
