"""Fixes in, cleaned tracks out: the formats of ``POST /v1/trajectories``."""
