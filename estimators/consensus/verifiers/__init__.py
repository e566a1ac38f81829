"""How much of a model's residuals is computed: one file per method."""
