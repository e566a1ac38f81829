"""The straight line: its frame, its fit, its words."""
