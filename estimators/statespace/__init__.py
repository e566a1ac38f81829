"""States that follow one another in time: smoothing along a chain."""
