"""Series of epochs that were corrected here: what :meth:`Epochs.from_observed` hands on, and phones."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from estimators import Epoch, Epochs, Fixes, PositionOptions, locate_series
from estimators.adapters.gnss_logger import read_gnss_logger
from estimators.geodesy.ellipsoid import to_cartesian
from estimators.geodesy.local_frame import enu_axes
from estimators.gnss.observed_epochs import ObservedEpochs
from estimators.gnss.snapshot.solved import solve_epochs
from tests.gnss.skies import make_sky

PARK = (37.422578, -122.081678, -28.0)
"""Where the log was recorded, to some metres."""


@pytest.fixture(scope="module")
def observed(gnss_data: Path) -> ObservedEpochs:
    folder = gnss_data / "google_2016_06_30"
    return read_gnss_logger(folder / "pseudoranges_log_2016_06_30_21_26_07.txt.gz", folder / "hour1820.16n")


def test_every_column_of_observed_epochs_is_handed_on_in_its_place(observed: ObservedEpochs) -> None:
    epochs, table = Epochs.from_observed(observed), observed.table
    assert len(epochs) == len(observed)
    k = len(observed) // 2
    own = slice(int(table.offsets[k]), int(table.offsets[k + 1]))
    epoch = epochs[k]
    assert epoch.time == observed.time_gps[k]
    np.testing.assert_array_equal(epoch.satellites_m, table.satellites_m[own])
    np.testing.assert_array_equal(epoch.pseudoranges_m, table.pseudoranges_m[own])
    np.testing.assert_array_equal(epoch.sigma_m, table.sigma_m[own])
    np.testing.assert_array_equal(epoch.range_rate_mps, observed.range_rate_mps[own])
    np.testing.assert_array_equal(epoch.satellite_velocity_mps, observed.velocities_mps[own])
    assert tuple(epoch.satellite or ()) == table.names[own]
    assert tuple(epoch.system or ()) == tuple(name[0] for name in table.names[own])
    np.testing.assert_array_equal(epochs.source_row, observed.source_row)


def test_observed_epochs_are_located_as_a_series(observed: ObservedEpochs) -> None:
    fixes = locate_series(Epochs.from_observed(observed), motion="static")
    assert isinstance(fixes, Fixes)
    east, north, _ = enu_axes(*PARK[:2]) @ (fixes.position_ecef_m[0] - to_cartesian(np.array(PARK)))
    assert np.hypot(east, north) < 10.0


def test_a_phone_is_doubted_as_far_as_its_own_noise_reaches(observed: ObservedEpochs) -> None:
    # Six satellites with 12 m of noise: their position is 10 m off as a rule and 20 m is no rarity.
    assert set(np.diff(observed.table.offsets).tolist()) == {6}
    flagged = []
    for alert_m in (20.0, 50.0, 100.0):
        options = PositionOptions(alert_m=alert_m)
        flagged.append(
            float(np.mean(solve_epochs(observed.table, options).far_probability >= options.ambiguity))
        )
    assert flagged[0] > 0.9
    assert flagged[0] > flagged[1] > flagged[2]
    assert flagged[2] < 0.5


@pytest.mark.parametrize("n", [4, 5])
def test_more_epochs_of_too_few_satellites_bound_nothing(n: int) -> None:
    sky = make_sky(n, 1)
    epochs = [
        Epoch(60.0 * k, sky.satellites_m, sky.ranges_m + 100.0 * k, sigma_m=sky.sigma_m, satellite=sky.names)
        for k in range(5)
    ]
    fixes = locate_series(epochs, motion="static")
    assert isinstance(fixes, Fixes)
    assert np.isinf(fixes.hpl_m).all()
    assert np.isinf(fixes.vpl_m).all()
    assert fixes.ambiguous.all() == (n == 4)
    assert fixes.to_dict()["fixes"]["hpl_m"] == [None] * 5
