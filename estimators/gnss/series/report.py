"""How the answer to a series reads: JSON-safe columns, a data frame, a few sentences."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from estimators.notices import notice_to_dict

if TYPE_CHECKING:
    import pandas as pd

    from estimators.gnss.series.fixes import Fixes


def _plain(values: npt.NDArray[Any]) -> Any:
    """Nested lists; None for what is not finite, ISO 8601 for points in time."""
    if values.dtype.kind == "M":
        return [str(value) for value in values]
    if values.dtype.kind != "f" or np.isfinite(values).all():
        return values.tolist()
    held = values.astype(object)
    held[~np.isfinite(values)] = None
    return held.tolist()


def _number(value: float) -> float | None:
    return value if np.isfinite(value) else None


def fixes_to_dict(fixes: Fixes) -> dict[str, Any]:
    """JSON-safe form, by columns: one entry per epoch under ``fixes``, per row under ``satellites``."""
    satellites = fixes.satellites
    return {
        "motion": fixes.motion,
        "motion_reason": fixes.motion_reason,
        "surroundings": fixes.surroundings,
        "surroundings_reason": fixes.surroundings_reason,
        "method": fixes.method,
        "window_s": fixes.window_s,
        "causal": fixes.causal,
        "sigma_scale": _number(fixes.sigma_scale),
        "correlation": _number(fixes.correlation),
        "fixes": {
            "time": _plain(fixes.time),
            "status": list(fixes.status),
            "position_ecef_m": _plain(fixes.position_ecef_m),
            "lat_deg": _plain(fixes.geodetic[:, 0]),
            "lon_deg": _plain(fixes.geodetic[:, 1]),
            "height_m": _plain(fixes.geodetic[:, 2]),
            "velocity_enu_mps": _plain(fixes.velocity_enu_mps),
            "covariance_enu_m2": _plain(fixes.covariance_enu_m2),
            "clocks_m": {letter: _plain(column) for letter, column in fixes.clocks_m.items()},
            "hpl_m": _plain(fixes.hpl_m),
            "vpl_m": _plain(fixes.vpl_m),
            "far_probability": _plain(fixes.far_probability),
            "ambiguous": fixes.ambiguous.tolist(),
        },
        "satellites": {
            "epoch": satellites.epoch.tolist(),
            "satellite": list(satellites.name),
            "system": list(satellites.system),
            "status": list(satellites.status),
            "inlier": satellites.inlier.tolist(),
            "fault_probability": _plain(satellites.fault_probability),
            "weight": _plain(satellites.weight),
            "residual_m": _plain(satellites.residual_m),
            "sigma_m": _plain(satellites.sigma_m),
            "reason": list(satellites.reason),
        },
        "rivals": [
            {
                "epochs": list(rival.epochs),
                "position_ecef_m": rival.position_ecef_m.tolist(),
                "distance_m": rival.distance_m,
                "probability": rival.probability,
            }
            for rival in fixes.rivals
        ],
        "notices": [notice_to_dict(item) for item in fixes.notices],
    }


def fixes_to_frame(fixes: Fixes) -> pd.DataFrame:
    """One row per epoch: time, status, position, velocity, standard deviations, levels, clocks."""
    import pandas as pd  # noqa: PLC0415

    columns: dict[str, Any] = {"time": fixes.time, "status": list(fixes.status)}
    columns |= {f"{axis}_m": fixes.position_ecef_m[:, j] for j, axis in enumerate("xyz")}
    columns |= {name: fixes.geodetic[:, j] for j, name in enumerate(("lat_deg", "lon_deg", "height_m"))}
    for j, axis in enumerate(("east", "north", "up")):
        columns[f"{axis}_mps"] = fixes.velocity_enu_mps[:, j]
        columns[f"sigma_{axis}_m"] = np.sqrt(fixes.covariance_enu_m2[:, j, j])
    columns |= {
        "hpl_m": fixes.hpl_m,
        "vpl_m": fixes.vpl_m,
        "far_probability": fixes.far_probability,
        "ambiguous": fixes.ambiguous,
    }
    columns |= {f"clock_{letter}_m": column for letter, column in fixes.clocks_m.items()}
    return pd.DataFrame(columns)


def summarise(fixes: Fixes) -> str:
    """Write a few sentences: how many epochs, how they were solved, how far off, who lied."""
    solved = fixes.solved
    lines = [
        f"{int(solved.sum())} of {len(fixes)} epochs have a position; {fixes.motion} receiver, "
        f"{fixes.surroundings} surroundings.",
        fixes.motion_reason,
        fixes.surroundings_reason,
    ]
    if solved.any():
        first = fixes.geodetic[solved][0]
        lines.append(
            f"First position {first[0]:.7f}, {first[1]:.7f}, height {first[2]:.1f} m; horizontal protection "
            f"level {float(np.median(fixes.hpl_m[solved])):.1f} m (median)."
        )
    left_out = Counter(
        name
        for name, status in zip(fixes.satellites.name, fixes.satellites.status, strict=True)
        if status == "excluded"
    )
    if left_out:
        most = ", ".join(f"{name} ({count})" for name, count in left_out.most_common(5))
        lines.append(f"{sum(left_out.values())} of {len(fixes.satellites)} ranges left out: {most}.")
    if fixes.ambiguous.any():
        lines.append(f"{int(fixes.ambiguous.sum())} epochs are ambiguous.")
    missing = Counter(status for status in fixes.status if status not in ("solved", "bridged"))
    lines.extend(f"{count} epochs without a position: {status}." for status, count in missing.items())
    lines.extend(f"Note: {item.message}" for item in fixes.notices)
    return "\n".join(lines)
