"""Trajectories: which fixes of a track lie, and where it really went."""
