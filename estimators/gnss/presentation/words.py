"""A fix in words, 80 columns wide: where, how sure, who lied and what to do about it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING

from estimators.gnss.systems import SYSTEMS
from estimators.notices import NoticeCode
from estimators.presentation.text import WIDTH, labelled

if TYPE_CHECKING:
    from estimators.gnss.fix import Fix, Integrity

_LABEL = 13

ADVICE: Mapping[NoticeCode, str] = MappingProxyType(
    {
        NoticeCode.ambiguous_faults: (
            "Do not use the position alone: take several epochs together, or more systems."
        ),
        NoticeCode.unchecked_position: "Add a satellite, or take several epochs together.",
        NoticeCode.untestable_satellites: (
            "Add a second satellite of their system, or leave the system out."
        ),
        NoticeCode.unbounded_error: (
            "Add satellites, take several epochs together, or accept a larger options.integrity_risk."
        ),
        NoticeCode.satellites_below_mask: "Lower options.elevation_mask_deg to use them.",
        NoticeCode.inconsistent_ranges: "Look at the sigmas, and at faults that the alert limit tolerates.",
    }
)
"""What to do about a notice."""


def fix_to_text(fix: Fix) -> str:
    """Text for people.

    Parameters
    ----------
    fix : Fix

    Returns
    -------
    str
        Without a newline at the end.
    """
    place, satellites = fix.geodetic, fix.satellites
    spread = [math.sqrt(fix.covariance_enu_m2[k, k]) for k in range(3)]
    used = int(satellites.inlier.sum())
    lines = [f"Position by {fix.method}", "━" * WIDTH]
    lines += labelled("Where", f"{place.lat_deg:.7f}° {place.lon_deg:.7f}° {place.height_m:.2f} m", _LABEL)
    lines += labelled(
        "Std. error", f"{spread[0]:.2f} m east, {spread[1]:.2f} m north, {spread[2]:.2f} m up", _LABEL
    )
    lines += labelled("Protection", _protection(fix.integrity), _LABEL)
    lines += labelled(
        "Satellites", f"{used} used of {len(satellites)}; HDOP {fix.dop.horizontal:.2f}", _LABEL
    )
    clocks = ", ".join(f"{SYSTEMS[letter]} {value:.2f} m" for letter, value in fix.clocks_m.items())
    lines += labelled("Clocks", clocks, _LABEL)
    out = [row for row, status in enumerate(satellites.status) if status == "excluded"]
    if out:
        lines += ["─" * WIDTH, "excluded      residual   elevation   azimuth   fault probability"]
    for row in out:
        lines.append(
            f"{satellites.name[row]:<10}{satellites.residual_m[row]:>+10.1f} m"
            f"{satellites.elevation_deg[row]:>10.0f}°{satellites.azimuth_deg[row]:>9.0f}°"
            f"{satellites.fault_probability[row]:>16.3g}"
        )
    if fix.rival is not None and fix.ambiguous:
        lines += labelled(
            "Rival", f"{fix.rival.distance_m:.0f} m away with probability {fix.rival.probability:.2g}", _LABEL
        )
    if fix.notices:
        lines.append("─" * WIDTH)
    for item in fix.notices:
        lines += labelled("Note", f"{item.message} {ADVICE.get(item.code, '')}".rstrip(), _LABEL)
    return "\n".join(lines)


def _protection(integrity: Integrity) -> str:
    assumed = (
        f"probability {integrity.risk:g} if each satellite is faulty with probability "
        f"{integrity.fault_prior:g}"
    )
    if math.isinf(integrity.hpl_m):
        return f"none: larger errors would go unnoticed with more than {assumed}"
    levels = f"{integrity.hpl_m:.1f} m horizontally, {integrity.vpl_m:.1f} m vertically"
    return f"{levels}, exceeded with {assumed}"
