"""Trends that are linear in their coefficients: polynomials, seasons, the caller's own columns."""
