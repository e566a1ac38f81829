"""What a caller may set about positions, besides the data."""

from __future__ import annotations

import math
from dataclasses import dataclass

from estimators.arrays import InputError

_PROBABILITIES = (
    "fault_prior",
    "ambiguity",
    "integrity_risk",
    "false_alarm",
    "missed_detection",
    "satellite_fault",
    "constellation_fault",
)


@dataclass(frozen=True, slots=True)
class PositionOptions:
    """Settings of fault exclusion; the defaults serve every method.

    Attributes
    ----------
    fault_prior : float
        Mean probability of a satellite to be faulty before the data are seen; faults come together. 0.1 is
        pessimistic on purpose: it widens protection levels (METHODS_GNSS).
    alert_m : float
        Horizontal error in metres that matters: an answer is ``ambiguous`` if the truth may lie beyond.
    ambiguity : float
        Probability of that from which an answer says so, faults that no range contradicts among it
        (METHODS_GNSS: 0.01 without these, and for faults that do not come together).
    integrity_risk : float
        Probability with which a protection level may be exceeded.
    false_alarm : float
        Probability of a test to refuse a healthy epoch (``raim``, ``greedy``, ``glrt``, ``araim``).
    missed_detection : float
        Probability with which the minimum detectable bias may go unnoticed.
    threshold_sigmas : float
        Consensus threshold in standard deviations of a residual (``p-ransac``, ``ranco``).
    most_faults : int
        Faults at the same time that ``ranco`` reckons with.
    satellite_fault, constellation_fault : float
        Probabilities that a satellite, and that a whole constellation, is faulty (``araim``; defaults
        customary in studies of it).
    nominal_bias_m : float
        Largest bias of the range of a healthy satellite in metres (``araim``; likewise).
    elevation_mask_deg : float or None
        Satellites below take no part.

    Raises
    ------
    InputError
        If a probability does not lie between 0 and 1, or a length is not positive.
    """

    fault_prior: float = 0.1
    alert_m: float = 20.0
    ambiguity: float = 0.02
    integrity_risk: float = 1e-5
    false_alarm: float = 1e-3
    missed_detection: float = 0.2
    threshold_sigmas: float = 3.5
    most_faults: int = 4
    satellite_fault: float = 1e-5
    constellation_fault: float = 1e-4
    nominal_bias_m: float = 0.75
    elevation_mask_deg: float | None = None

    def __post_init__(self) -> None:
        for name in _PROBABILITIES:
            if not 0.0 < getattr(self, name) < 1.0:
                raise InputError(f"options.{name}", "must lie between 0 and 1, both excluded")
        for name in ("alert_m", "threshold_sigmas"):
            if not (math.isfinite(getattr(self, name)) and getattr(self, name) > 0.0):
                raise InputError(f"options.{name}", "must be a positive number")
        if self.most_faults < 1:
            raise InputError("options.most_faults", "must be at least 1")
        if not (math.isfinite(self.nominal_bias_m) and self.nominal_bias_m >= 0.0):
            raise InputError("options.nominal_bias_m", "must not be negative")
        mask = self.elevation_mask_deg
        if mask is not None and not -90.0 <= mask < 90.0:
            raise InputError("options.elevation_mask_deg", "must lie between -90 and 90 degrees")
