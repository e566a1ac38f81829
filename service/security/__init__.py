"""Who may ask, and what browsers are told."""
