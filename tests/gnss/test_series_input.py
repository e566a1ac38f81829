from __future__ import annotations

import dataclasses
import json

import numpy as np
import pytest

from benchmarks.positions.drives import drive, mast
from estimators import (
    Epoch,
    Epochs,
    Fixes,
    InputError,
    NoFit,
    PositionOptions,
    locate,
    locate_series,
    locate_stream,
)


def columns_of(epochs: list[Epoch]) -> dict[str, object]:
    rows = [len(np.asarray(epoch.pseudoranges_m)) for epoch in epochs]
    return {
        "time": np.repeat([epoch.time for epoch in epochs], rows),
        "satellites_m": np.concatenate([np.asarray(epoch.satellites_m) for epoch in epochs]),
        "pseudoranges_m": np.concatenate([np.asarray(epoch.pseudoranges_m) for epoch in epochs]),
        "sigma_m": np.concatenate([np.asarray(epoch.sigma_m) for epoch in epochs]),
        "system": [name for epoch in epochs for name in epoch.system or ()],
        "satellite": [name for epoch in epochs for name in epoch.satellite or ()],
    }


def test_columns_and_epochs_give_the_same_bytes() -> None:
    standing = drive(6, path=mast, step_s=60.0, seed=1)
    epochs = Epochs.from_columns(**columns_of(standing.epochs))  # type: ignore[arg-type]
    one, other = locate_series(standing.epochs), locate_series(epochs)
    assert isinstance(one, Fixes)
    assert isinstance(other, Fixes)
    assert one.position_ecef_m.tobytes() == other.position_ecef_m.tobytes()


def test_rows_of_an_epoch_need_not_stand_together() -> None:
    columns = columns_of(drive(3, path=mast, step_s=60.0).epochs)
    order = np.random.default_rng(0).permutation(len(columns["system"]))  # type: ignore[arg-type]
    mixed = {name: [list(values)[k] for k in order] for name, values in columns.items()}  # type: ignore[call-overload]
    epochs = Epochs.from_columns(**mixed)
    assert len(epochs) == 3
    assert sorted(epochs.source_row.tolist()) == list(range(order.size))
    np.testing.assert_array_equal(epochs.pseudoranges_m, np.array(mixed["pseudoranges_m"])[epochs.source_row])


def test_epochs_are_a_sequence_with_slices_and_negative_numbers() -> None:
    epochs = Epochs.from_columns(**columns_of(drive(4, path=mast).epochs))  # type: ignore[arg-type]
    assert epochs[-1].time == 3.0
    assert [epoch.time for epoch in epochs[1:3]] == [1.0, 2.0]
    with pytest.raises(IndexError):
        epochs[4]


def test_points_in_time_come_back_as_they_were() -> None:
    standing = drive(5, path=mast, step_s=60.0)
    start = np.datetime64("2020-06-25T00:00:00", "ns")
    dated = [
        dataclasses.replace(epoch, time=start + np.timedelta64(int(60 * k), "s"))
        for k, epoch in enumerate(standing.epochs)
    ]
    fixes = locate_series(dated)
    assert isinstance(fixes, Fixes)
    assert fixes.time[1] == np.datetime64("2020-06-25T00:01:00")
    assert fixes.to_dict()["fixes"]["time"][1].startswith("2020-06-25T00:01:00")


def test_one_epoch_is_answered_as_by_locate() -> None:
    epoch = drive(1, path=mast, seed=4, faults=1).epochs[0]
    fixes = locate_series([epoch])
    alone = locate(
        epoch.satellites_m,
        epoch.pseudoranges_m,
        sigma_m=epoch.sigma_m,
        system=epoch.system,
        satellite=epoch.satellite,
    )
    assert isinstance(fixes, Fixes)
    assert alone
    assert fixes.motion == "independent"
    np.testing.assert_array_equal(fixes.position_ecef_m[0], alone.position_ecef_m)  # type: ignore[union-attr]
    assert fixes[0].excluded == alone.excluded  # type: ignore[union-attr]


def test_named_methods_work_on_single_epochs() -> None:
    standing = drive(4, path=mast, seed=5, faults=1)
    fixes = locate_series(standing.epochs, motion="independent", method="raim")
    assert isinstance(fixes, Fixes)
    assert fixes.method == "raim"
    with pytest.raises(InputError, match="independent"):
        locate_series(standing.epochs, method="raim")


def test_answers_are_json_of_columns_and_frames_of_epochs() -> None:
    standing = drive(5, path=mast, step_s=60.0, faults=1)
    ranges = np.asarray(standing.epochs[1].pseudoranges_m).copy()
    ranges[2] = np.nan
    standing.epochs[1] = dataclasses.replace(standing.epochs[1], pseudoranges_m=ranges)
    fixes = locate_series(standing.epochs)
    assert isinstance(fixes, Fixes)
    told = json.loads(json.dumps(fixes.to_dict(), allow_nan=False))
    assert len(told["fixes"]["time"]) == 5
    assert len(told["satellites"]["residual_m"]) == len(fixes.satellites)
    assert len(fixes.to_frame()) == 5
    assert "5 of 5 epochs" in fixes.summary()
    assert [fix.time for fix in fixes] == [0.0, 60.0, 120.0, 180.0, 240.0]


def test_progress_ends_with_all_epochs() -> None:
    seen: list[tuple[int, int]] = []
    locate_series(
        drive(30, seed=1).epochs, motion="moving", progress=lambda done, total: seen.append((done, total))
    )
    assert seen[-1] == (30, 30)
    assert [done for done, _ in seen] == sorted(done for done, _ in seen)


def test_a_mask_leaves_low_satellites_out() -> None:
    fixes = locate_series(
        drive(6, path=mast, step_s=60.0, systems="GE").epochs,
        options=PositionOptions(elevation_mask_deg=25.0),
    )
    assert isinstance(fixes, Fixes)
    assert "masked" in fixes.satellites.status
    assert any(item.code == "satellites_below_mask" for item in fixes.notices)


def test_sigmas_follow_the_elevation_where_none_are_given() -> None:
    plain = [dataclasses.replace(epoch, sigma_m=None) for epoch in drive(4, path=mast).epochs]
    fixes = locate_series(plain)
    assert isinstance(fixes, Fixes)
    assert np.ptp(fixes.satellites.sigma_m) > 0.0
    assert fixes.satellites.sigma_m.min() > 2.0


def test_too_few_satellites_everywhere_is_no_fit_that_says_how_to_mend_it() -> None:
    short = [
        Epoch(epoch.time, np.asarray(epoch.satellites_m)[:3], np.asarray(epoch.pseudoranges_m)[:3])
        for epoch in drive(4, path=mast).epochs
    ]
    answer = locate_series(short)
    assert isinstance(answer, NoFit)
    assert answer.reason == "too_few_satellites"
    assert "send" in answer.message


@pytest.mark.parametrize(
    ("field", "arguments"),
    [
        ("motion", {"motion": "flying"}),
        ("surroundings", {"surroundings": "sea"}),
        ("window_s", {"window_s": -1.0}),
        ("method", {"method": "magic"}),
        ("causal", {"causal": True, "motion": "static"}),
    ],
)
def test_arguments_that_make_no_sense_are_refused(field: str, arguments: dict[str, object]) -> None:
    with pytest.raises(InputError) as caught:
        locate_series(drive(2, path=mast).epochs, **arguments)  # type: ignore[arg-type]
    assert caught.value.field == field


def test_errors_name_the_epoch() -> None:
    epochs = drive(3, path=mast).epochs
    epochs[1] = dataclasses.replace(epochs[1], pseudoranges_m=np.asarray(epochs[1].pseudoranges_m)[:-1])
    with pytest.raises(InputError, match="epoch 1"):
        locate_series(epochs)


def test_epochs_without_a_time_and_no_epochs_at_all_are_refused() -> None:
    epochs = drive(2, path=mast).epochs
    with pytest.raises(InputError) as caught:
        locate_series([dataclasses.replace(epochs[0], time=float("nan")), epochs[1]])
    assert caught.value.field == "time"
    with pytest.raises(InputError):
        locate_series([])


def test_range_rates_need_the_velocities_of_the_satellites() -> None:
    epoch = drive(1, path=mast).epochs[0]
    rates = np.zeros(len(np.asarray(epoch.pseudoranges_m)))
    with pytest.raises(InputError) as caught:
        locate_series([dataclasses.replace(epoch, range_rate_mps=rates)])
    assert caught.value.field == "satellite_velocity_mps"


def test_a_stream_that_goes_back_in_time_is_refused() -> None:
    epochs = drive(3, path=mast).epochs
    with pytest.raises(InputError, match="order of time"):
        list(locate_stream(epochs[::-1]))
