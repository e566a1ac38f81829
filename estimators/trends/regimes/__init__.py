"""Regimes: stretches of a series that follow a line each, and the fit of the present one."""
