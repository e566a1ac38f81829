"""Pseudoranges in, positions out: the formats of ``POST /v1/positions``."""
