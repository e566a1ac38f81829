"""``python -m benchmarks.tracks``: cleaned tracks beside peers, on tracks whose truth is known."""
