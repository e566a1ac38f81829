"""Positions from pseudoranges: fixes, faulty satellites, protection levels."""
