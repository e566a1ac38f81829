"""What operators see: logs, metrics and timings. Neither bodies nor keys pass through here."""
