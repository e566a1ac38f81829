"""The threshold-free structure for models of any number of columns: polynomials, seasons, covariates."""
