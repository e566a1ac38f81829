"""RINEX observation and navigation files as corrected epochs (extra ``[rinex]``): :func:`read_rinex`."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from estimators.adapters.rinex_navigation import read_navigation
from estimators.adapters.rinex_observations import CODES, read_observations
from estimators.adapters.rinex_text import MOST_BYTES, Source
from estimators.gnss.corrections.measured import Weights
from estimators.gnss.observed_epochs import ObservedEpochs
from estimators.gnss.orbits.broadcast import (
    Ionosphere,
    Navigation,
    check_ionosphere,
    correct_observations,
    read_letters,
)

__all__ = ["Navigation", "Source", "read_navigation", "read_rinex"]


def read_rinex(
    observations: Source,
    navigation: Source | Sequence[Source] | Navigation,
    *,
    systems: Sequence[str] | None = None,
    mask_deg: float = 10.0,
    weights: Weights = "elevation",
    ionosphere: Ionosphere = "auto",
    most_bytes: int = MOST_BYTES,
    check: Callable[[], object] | None = None,
) -> ObservedEpochs:
    """Read epochs of pseudoranges, and correct them by the broadcast messages.

    Parameters
    ----------
    observations : bytes or Path
        RINEX 2 or 3; plain, gzip or Hatanaka-compressed.
    navigation : bytes, Path, sequence of these, or Navigation
        RINEX 2 or 3, plain or gzip; several are taken together.
    systems : sequence of str, optional
        Letters or names of GPS, GLONASS, Galileo, BeiDou and QZSS. Default: all of them.
    mask_deg : float
        Satellites below are left out.
    weights : {"elevation", "strength"}
        Noise by elevation, or by signal strength.
    ionosphere : {"auto", "broadcast", "dual", "none"}
        ``broadcast``: by the coefficients of the navigation file; ``auto``: by them if it has any;
        ``dual``: by two codes, and satellites without a second code are left out.
    most_bytes : int
        Unpacked size above which a file, or the navigation files together, are refused.
    check : callable, optional
        Called now and then while a file is read; what it raises ends the reading.

    Returns
    -------
    ObservedEpochs
        Epochs in time order; those that lost all satellites included.

    Raises
    ------
    InputError
        If a file is not what it should be, or the navigation file covers none of the observations.

    Examples
    --------
    >>> from pathlib import Path
    >>> read_rinex(Path("no/such.rnx"), Path("no/such.nav"))
    Traceback (most recent call last):
        ...
    estimators.arrays.InputError: navigation: cannot be read: No such file or directory
    """
    letters = read_letters(systems, "".join(CODES))
    check_ionosphere(ionosphere)
    messages = navigation if isinstance(navigation, Navigation) else read_navigation(navigation, most_bytes)
    observed = read_observations(observations, letters, 1 if ionosphere != "dual" else 3, most_bytes, check)
    return correct_observations(observed, messages, ionosphere=ionosphere, weights=weights, mask_deg=mask_deg)
