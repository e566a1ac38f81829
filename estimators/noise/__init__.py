"""Noise scale: of residuals, of differences between neighbours, and the least scale the values can show."""

from estimators.noise.differences import difference_scale, interquartile_difference_scale
from estimators.noise.mad import MAD_FACTOR, mad_scale, residual_scale
from estimators.noise.resolution import Quantisation, find_quantisation, scale_floor

__all__ = [
    "MAD_FACTOR",
    "Quantisation",
    "difference_scale",
    "find_quantisation",
    "interquartile_difference_scale",
    "mad_scale",
    "residual_scale",
    "scale_floor",
]
