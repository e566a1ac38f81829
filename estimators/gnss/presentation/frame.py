"""The satellites of a fix as a pandas data frame: one row per input row."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import pandas as pd

    from estimators.gnss.fix import Fix


def fix_to_frame(fix: Fix) -> pd.DataFrame:
    """One row per satellite, in input order.

    Parameters
    ----------
    fix : Fix

    Raises
    ------
    ImportError
        If pandas is not installed (extra ``[pandas]``).
    """
    import pandas as pd  # noqa: PLC0415

    inner = fix.satellites
    return pd.DataFrame(
        {
            "satellite": list(inner.name),
            "system": list(inner.system),
            "status": pd.Categorical(
                list(inner.status), categories=["used", "excluded", "untestable", "masked", "missing"]
            ),
            "fault_probability": inner.fault_probability,
            "weight": inner.weight,
            "residual_m": inner.residual_m,
            "sigma_m": inner.sigma_m,
            "statistic": inner.statistic,
            "mdb_m": inner.mdb_m,
            "azimuth_deg": inner.azimuth_deg,
            "elevation_deg": inner.elevation_deg,
            "reason": list(inner.reason),
        }
    )
