"""Honest uncertainty: intervals, serial correlation, probabilities per point, p-values."""
