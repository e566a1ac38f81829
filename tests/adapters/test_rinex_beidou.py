"""BeiDou's B1, which RINEX 3.02 numbers as band 1 and all other versions as band 2."""

import gzip
from pathlib import Path

import numpy as np

from estimators.adapters import rinex


def test_the_old_number_of_beidous_first_band_is_read_as_the_new(gnss_data: Path) -> None:
    folder = gnss_data / "esbc_2020_177"
    lines = gzip.decompress((folder / "ESBC00DNK_20201770000_120S.rnx.gz").read_bytes()).decode().split("\n")
    third = [k for k, line in enumerate(lines) if line.startswith(">")][2]
    new = lines[:third]
    old = [
        line.replace("2I ", "1I ") if line.startswith("C") and line.endswith("SYS / # / OBS TYPES") else line
        for line in new
    ]
    old[0] = old[0].replace("3.05", "3.02")
    assert "C1I" in "".join(old)
    navigation = folder / "ESBC00DNK_R_20201770000_01D_MN.rnx.gz"
    first, second = (
        rinex.read_rinex("\n".join(text).encode(), navigation, systems=["G", "E", "C"]) for text in (new, old)
    )
    assert "C" in {name[0] for name in first.table.names}
    assert second.table.names == first.table.names
    np.testing.assert_array_equal(second.table.pseudoranges_m, first.table.pseudoranges_m)
    np.testing.assert_array_equal(second.cn0_dbhz, first.cn0_dbhz)
    np.testing.assert_array_equal(second.range_rate_mps, first.range_rate_mps)
