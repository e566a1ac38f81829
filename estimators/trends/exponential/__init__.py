"""Exponential growth and decay, under noise that grows with the level or noise that does not."""
