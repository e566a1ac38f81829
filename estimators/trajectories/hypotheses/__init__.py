"""Hypotheses of the motion in short windows, found by the one engine of consensus."""
