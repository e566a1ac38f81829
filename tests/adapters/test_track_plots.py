"""Pictures of tracks, looked at through their SVG and through what is decided before they are drawn."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimators import Track, clean_trajectory
from estimators.adapters.figure_sheet import PALETTES
from estimators.adapters.plotting import render
from estimators.adapters.track_map import frame_of
from estimators.adapters.track_marks import MARKS, faulty_rows
from estimators.adapters.track_plots import error_figure, map_figure
from estimators.adapters.track_sheet import TrackSheet, vertices
from estimators.adapters.track_view import View, metres_text, round_length
from estimators.arrays import FloatArray, InputError
from estimators.geodesy.plane import Plane
from estimators.trajectories.reasons import FixReason

N = 120
SPIKE, FAR = 40, 80
KINDS: Any = pytest.mark.parametrize("kind", ["map", "error"])
SIZE = np.array([700.0, 500.0])


def walk_m(n: int = N) -> FloatArray:
    random = np.random.default_rng(3)
    t = np.arange(n)
    places = np.column_stack([8.0 * t, 60.0 * np.sin(t / 15.0)]) + random.normal(0.0, 2.0, (n, 2))
    places[SPIKE] += [0.0, 90.0]
    places[FAR] += [0.0, 3000.0]
    return np.asarray(places)


def track_at(latitude: float = 48.0, longitude: float = 11.0, times: Any = None, n: int = N) -> Track:
    places = Plane(latitude, longitude).locate(walk_m(n))
    track = clean_trajectory(np.arange(float(n)) if times is None else times, *places)
    assert isinstance(track, Track)
    return track


@pytest.fixture(scope="module")
def track() -> Track:
    return track_at()


def sheet_of(track: Track, width: int = 800, height: int = 600) -> TrackSheet:
    return TrackSheet.of(track, PALETTES["light"], width, height)


def texts(track: Track, kind: Any = "map", **style: Any) -> list[str]:
    root = ET.fromstring(render(track.plot(kind, **style), "svg"))
    return ["".join(node.itertext()) for node in root.iter("{http://www.w3.org/2000/svg}text")]


@KINDS
def test_the_legend_counts_the_fixes_of_each_reason(track: Track, kind: str) -> None:
    reasons = track.points.reason
    assert reasons[SPIKE] == reasons[FAR] == "spike"
    said = texts(track, kind)
    assert f"spike ({reasons.count('spike')})" in said
    assert f"good ({reasons.count('ok')})" in said


def test_the_map_says_how_many_fixes_lie_beyond_it_and_how_far(track: Track) -> None:
    (said,) = [text for text in texts(track) if text.startswith("beyond the map")]
    assert said == f"beyond the map (1, to {metres_text(float(track.points.residual_m[FAR]))})"


def test_the_map_has_a_scale_and_says_where_it_is(track: Track) -> None:
    said = texts(track)
    assert any(re.fullmatch(r"[125]0* k?m", text) for text in said)
    assert "N" in said
    assert any(re.fullmatch(r"middle 4[78]\.\d{4}° N, 11\.\d{4}° E", text) for text in said)


def test_a_far_fix_does_not_enlarge_the_map_and_a_near_one_may(track: Track) -> None:
    sheet = sheet_of(track)
    shown = frame_of(sheet, SIZE).shows(sheet.fix_m)
    assert not shown[FAR]
    assert shown[SPIKE]
    assert shown[~faulty_rows(sheet)].all()


@pytest.mark.parametrize("place", [(48.0, 180.0), (90.0, 0.0), (-90.0, 40.0), (0.0, 0.0)])
def test_a_map_has_the_same_shape_at_the_antimeridian_and_at_a_pole(
    place: tuple[float, float], track: Track
) -> None:
    here, there = (sheet_of(one).fix_m for one in (track, track_at(*place)))
    # Only directions differ: at a pole, north is that of the middle of the track.
    here_m, there_m = (np.linalg.norm(fixes - fixes[0], axis=1) for fixes in (here, there))
    np.testing.assert_allclose(there_m, here_m, rtol=1e-4, atol=0.01)


def test_both_directions_of_a_map_have_one_scale(track: Track) -> None:
    axes = map_figure(track, width_px=900, height_px=300).axes[0]
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    place = axes.get_position()
    assert (right - left) / (place.width * 900) == pytest.approx((high - low) / (place.height * 300))


def test_a_gap_is_dotted_and_named() -> None:
    times = np.arange(float(N)) + np.where(np.arange(N) >= 60, 300.0, 0.0)
    track = track_at(times=times)
    assert "across a gap" in texts(track)
    assert np.flatnonzero(sheet_of(track).after_gap).tolist() == [60]


def test_fixes_out_of_order_are_drawn_in_order_of_time(track: Track) -> None:
    turned = clean_trajectory(track.time[::-1], track.input_lat_deg[::-1], track.input_lon_deg[::-1])
    assert isinstance(turned, Track)
    np.testing.assert_allclose(sheet_of(turned).fix_m, sheet_of(track).fix_m, atol=1e-6)


def test_rows_without_a_place_are_counted_as_invalid() -> None:
    lat, lon = Plane(48.0, 11.0).locate(walk_m())
    lat[5] = 91.0
    track = clean_trajectory(np.arange(float(N)), lat, lon)
    assert isinstance(track, Track)
    for kind in ("map", "error"):
        assert "invalid (1)" in texts(track, kind)


def test_metres_and_kilometres_are_both_on_the_scale_of_errors(track: Track) -> None:
    axes = error_figure(track).axes[0]
    low, high = axes.get_ylim()
    assert low == 0.0
    assert high > float(np.nanmax(track.points.residual_m))
    # Good fixes keep a fifth of the height beside one that is 3 km off.
    good = float(np.quantile(track.points.residual_m[track.points.inlier], 0.95))
    place = axes.transAxes.inverted().transform(axes.transData.transform((0.0, good)))
    assert place[1] > 0.1
    assert "1 km" in texts(track, "error")


def test_times_are_dates_where_they_are_points_in_time() -> None:
    start = np.datetime64("2025-09-01T08:00:00", "ns")
    track = track_at(times=start + np.arange(N) * np.timedelta64(1, "s"))
    said = texts(track, "error")
    assert "UTC" in said
    assert any("2025-Sep-01" in text for text in said)


def test_long_numbers_are_counted_from_the_first() -> None:
    said = texts(track_at(times=1.7e9 + np.arange(float(N))), "error")
    assert "since 1700000000" in said
    assert "100" in said


def test_a_low_picture_of_errors_leaves_the_speed_out(track: Track) -> None:
    assert "speed, m/s" in texts(track, "error")
    assert "speed, m/s" not in texts(track, "error", height_px=200)


@KINDS
@pytest.mark.parametrize("size", [(800, 600), (400, 300), (200, 150), (1201, 333)])
@pytest.mark.parametrize("theme", ["light", "dark"])
def test_a_png_has_the_pixels_asked_for(track: Track, kind: Any, size: tuple[int, int], theme: Any) -> None:
    png = render(track.plot(kind, width_px=size[0], height_px=size[1], theme=theme), "png")
    assert (int.from_bytes(png[16:20]), int.from_bytes(png[20:24])) == size


@KINDS
@pytest.mark.parametrize("form", ["svg", "png"])
def test_two_renders_are_byte_equal(track: Track, kind: Any, form: Any) -> None:
    assert render(track.plot(kind), form) == render(track.plot(kind), form)


@KINDS
def test_a_title_is_taken_literally_and_an_empty_one_left_out(track: Track, kind: Any) -> None:
    assert "Ride $1$" in texts(track, kind, title="Ride $1$")
    assert len(texts(track, kind, title="")) == len(texts(track, kind, title="x")) - 1


@pytest.mark.parametrize("style", [{"width_px": 10}, {"theme": "sepia"}, {"kind": "sky"}])
def test_what_cannot_be_drawn_is_refused(track: Track, style: dict[str, Any]) -> None:
    with pytest.raises(InputError):
        track.plot(**style)


@KINDS
@pytest.mark.parametrize("n", [2, 3, 12])
def test_short_and_standing_tracks_are_drawn(kind: Any, n: int) -> None:
    standing = clean_trajectory(np.arange(float(n)), np.full(n, 48.0), np.full(n, 11.0))
    assert isinstance(standing, Track)
    assert render(standing.plot(kind), "png").startswith(b"\x89PNG")


def test_very_many_fixes_make_a_picture_of_bounded_size() -> None:
    n = 60_000
    t = np.arange(float(n))
    random = np.random.default_rng(1)
    places = np.column_stack([3000.0 * np.sin(t / 900.0), 2000.0 * np.sin(t / 1300.0)])
    lat, lon = Plane(48.0, 11.0).locate(places + random.normal(0.0, 3.0, (n, 2)))
    long = clean_trajectory(t, lat, lon, method="speed-gate")
    assert isinstance(long, Track)
    for kind in ("map", "error"):
        assert len(render(long.plot(kind), "svg")) < 2_000_000  # type: ignore[arg-type]


def test_every_reason_has_a_shape_and_a_colour_of_its_own() -> None:
    looks = [(mark.marker, mark.colour, mark.hollow) for mark in MARKS.values()]
    assert set(MARKS) == set(FixReason)
    assert len(set(looks)) == len(MARKS)


metres = st.floats(-1e6, 1e6)


@given(st.lists(st.tuples(metres, metres), min_size=1, max_size=20), metres, metres)
def test_marks_of_what_lies_beyond_stand_inside_the_rim(
    core: list[tuple[float, float]], east: float, north: float
) -> None:
    view = View.over(np.array(core), np.array([[east, north]]), SIZE)
    assert view.shows(np.array(core)).all()
    rim = view.to_rim(np.array(core[:1]), np.array([[east, north]]))
    pixels = view.in_pixels(rim)
    assert np.all((pixels > 1.0) & (pixels < SIZE - 1.0))


@given(st.floats(1e-3, 1e7))
def test_the_bar_of_the_scale_is_as_long_as_fits_and_round(most: float) -> None:
    length = round_length(most)
    assert 0.39 * most <= length <= most * (1.0 + 1e-9)
    assert f"{length:e}"[0] in "125"


@given(st.integers(2, 400), st.integers(2, 50), st.integers(0, 2**32 - 1))
def test_a_thinned_line_keeps_its_ends_and_its_bound(n: int, most: int, seed: int) -> None:
    x, y = np.cumsum(np.random.default_rng(seed).normal(0.0, 3.0, (2, n)), axis=1)
    kept = vertices(x, y, 0.5, most)
    assert kept[0] == 0
    assert kept[-1] == n - 1
    assert kept.size <= most
    assert np.all(np.diff(kept) > 0)
