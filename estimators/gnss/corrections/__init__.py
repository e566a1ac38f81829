"""Corrections of measured pseudoranges: satellite clock, ionosphere, troposphere, Earth rotation."""
