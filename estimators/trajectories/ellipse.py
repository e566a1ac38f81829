"""An error ellipse as the circle that the engine takes: :func:`accuracy_of_ellipse`."""

from __future__ import annotations

import math

import numpy as np

from estimators.arrays import ArrayLike, FloatArray, InputError, as_vector

RADIUS_68 = math.sqrt(-2.0 * math.log(0.32))
"""Radius of the circle that holds 68 % of errors of standard deviation 1 per axis (Rayleigh): 1.5096."""


def accuracy_of_ellipse(semi_major_m: ArrayLike, semi_minor_m: ArrayLike) -> FloatArray:
    """Radius that holds 68 % of errors, of a circle with the mean square of an error ellipse.

    The noise of a fix is the same in all directions to :func:`estimators.clean_trajectory`. Of an ellipse it
    takes how large it is, so that fixes of large ellipses count less; how it lies is not used, and a long
    thin one is taken as a circle that is too wide across it and too narrow along it.

    Parameters
    ----------
    semi_major_m, semi_minor_m : array_like, shape (n,)
        Standard deviations along the axes, metres, as Argos and the NMEA sentence GST give them; NaN, None
        and negative numbers are missing.

    Returns
    -------
    ndarray of float64, shape (n,)
        For ``accuracy_m``: 1.5096 sqrt((a^2 + b^2) / 2); NaN where either axis is missing.

    Raises
    ------
    InputError
        If columns differ in length or hold no numbers.

    Examples
    --------
    >>> accuracy_of_ellipse([400.0, 1500.0], [400.0, 90.0]).round()
    array([ 604., 1604.])
    """
    major, minor = as_vector(semi_major_m, "semi_major_m"), as_vector(semi_minor_m, "semi_minor_m")
    if minor.size != major.size:
        raise InputError(
            "semi_minor_m", f"{minor.size} values for {major.size} of semi_major_m; give one for each"
        )
    with np.errstate(invalid="ignore"):
        known = np.isfinite(major) & np.isfinite(minor) & (major >= 0.0) & (minor >= 0.0)
    radius = np.full(major.size, np.nan)
    radius[known] = RADIUS_68 * np.hypot(major[known], minor[known]) / math.sqrt(2.0)
    return radius
