"""Many epochs jointly: a receiver that stands or moves, satellites that lie now and then or always."""
