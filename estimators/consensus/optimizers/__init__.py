"""Local optimisation of models from minimal samples: one file per method, one contract: never worse."""
