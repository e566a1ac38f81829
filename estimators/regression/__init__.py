"""Estimators without sampling: least squares, M- and S-estimators, Theil-Sen, repeated medians."""
