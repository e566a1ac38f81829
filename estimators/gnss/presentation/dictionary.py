"""A :class:`~estimators.gnss.fix.Fix` as a JSON-safe dict (the keys of the wire format) and as GeoJSON."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from estimators.notices import notice_to_dict
from estimators.presentation.json_values import numbers_to_json

if TYPE_CHECKING:
    from estimators.gnss.fix import Fix, Rival, Satellites


def _bound(level: float) -> float | None:
    """Protection level, None where nothing bounds the error."""
    return level if math.isfinite(level) else None


def fix_to_dict(fix: Fix, *, satellites: bool = True) -> dict[str, Any]:
    """JSON-safe form of an answer.

    Parameters
    ----------
    fix : Fix
    satellites : bool
        Whether to include the columns per satellite.
    """
    consensus = fix.consensus
    answer: dict[str, Any] = {
        "method": fix.method,
        "position": {
            "ecef_m": fix.position_ecef_m.tolist(),
            "lat_deg": fix.geodetic.lat_deg,
            "lon_deg": fix.geodetic.lon_deg,
            "height_m": fix.geodetic.height_m,
        },
        "covariance_enu_m2": fix.covariance_enu_m2.tolist(),
        "clocks_m": dict(fix.clocks_m),
        "dop": {
            "gdop": fix.dop.geometric,
            "pdop": fix.dop.position,
            "hdop": fix.dop.horizontal,
            "vdop": fix.dop.vertical,
            "tdop": fix.dop.time,
        },
        "integrity": {
            "hpl_m": _bound(fix.hpl_m),
            "vpl_m": _bound(fix.vpl_m),
            "risk": fix.integrity.risk,
            "fault_prior": fix.integrity.fault_prior,
            "method": fix.integrity.method,
        },
        "global_test": {
            "statistic": fix.global_test.statistic,
            "dof": fix.global_test.dof,
            "threshold": fix.global_test.threshold,
            "p_value": fix.global_test.p_value,
        },
        "ambiguous": fix.ambiguous,
        "far_probability": fix.far_probability,
        "rival": None if fix.rival is None else _rival(fix.rival, fix.satellites),
        "sigma_scale": fix.sigma_scale,
        "consensus": {
            "n": consensus.n,
            "inliers": consensus.inliers,
            "inlier_ratio": consensus.inlier_ratio,
            "scored": consensus.ledger.scored,
            "search": consensus.search,
        },
        "notices": [notice_to_dict(item) for item in fix.notices],
    }
    if satellites:
        answer["satellites"] = satellites_to_dict(fix.satellites)
    return answer


def satellites_to_dict(satellites: Satellites) -> dict[str, Any]:
    """JSON-safe columns, one entry per input row."""
    return {
        "satellite": list(satellites.name),
        "system": list(satellites.system),
        "status": list(satellites.status),
        "fault_probability": numbers_to_json(satellites.fault_probability),
        "weight": numbers_to_json(satellites.weight),
        "residual_m": numbers_to_json(satellites.residual_m),
        "sigma_m": numbers_to_json(satellites.sigma_m),
        "statistic": numbers_to_json(satellites.statistic),
        "threshold": satellites.threshold,
        "mdb_m": numbers_to_json(satellites.mdb_m),
        "azimuth_deg": numbers_to_json(satellites.azimuth_deg),
        "elevation_deg": numbers_to_json(satellites.elevation_deg),
        "reason": list(satellites.reason),
    }


def _rival(rival: Rival, satellites: Satellites) -> dict[str, Any]:
    return {
        "ecef_m": rival.position_ecef_m.tolist(),
        "distance_m": rival.distance_m,
        "probability": rival.probability,
        "excluded": [name for name, out in zip(satellites.name, rival.excluded, strict=True) if out],
    }


def fix_to_feature(fix: Fix) -> dict[str, Any]:
    """GeoJSON feature (RFC 7946): the position with what a map shows of it."""
    place = fix.geodetic
    return {
        "type": "Feature",
        "geometry": {
            "type": "Point",
            "coordinates": [round(place.lon_deg, 9), round(place.lat_deg, 9), round(place.height_m, 4)],
        },
        "properties": {
            "method": fix.method,
            "hpl_m": _bound(fix.hpl_m),
            "vpl_m": _bound(fix.vpl_m),
            "ambiguous": fix.ambiguous,
            "used": int(fix.satellites.inlier.sum()),
            "excluded": list(fix.excluded),
        },
    }
