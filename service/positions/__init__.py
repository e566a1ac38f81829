"""From ranges as they came, in tables or in files, to positions."""
