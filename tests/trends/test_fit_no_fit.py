"""NoFit is an answer like every other: falsy, in words, as a dict, as a frame, in a notebook."""

from __future__ import annotations

import json
import subprocess
import sys

import numpy as np
import pandas as pd

from tests.trends.contaminated import refused


def test_it_says_in_words_what_is_wrong_and_what_was_seen() -> None:
    text = refused([0.0, 1.0], [np.nan, 1.0]).summary()
    assert text.startswith("No fit (too_few_points): One usable point")
    assert "missing" in text


def test_its_dict_can_be_sent_as_json() -> None:
    body = json.loads(json.dumps(refused([0.0, 1.0], [np.nan, 1.0]).to_dict()))
    assert body["reason"] == "too_few_points"
    assert body["points"]["reason"] == ["missing", "ok"]


def test_its_frame_has_a_row_per_row_and_the_reasons() -> None:
    frame = refused(np.array(["2024-01-01", "2024-01-02"], dtype="datetime64[D]"), [np.nan, 1.0]).to_frame()
    assert list(frame["reason"]) == ["missing", "ok"]
    assert list(frame["time"]) == [pd.Timestamp("2024-01-01"), pd.Timestamp("2024-01-02")]
    assert frame["inlier"].tolist() == [False, False]
    assert frame["residual"].isna().all()


def test_its_frame_of_nothing_is_empty() -> None:
    assert refused([], []).to_frame().empty


def test_a_notebook_shows_the_reason_and_the_notices() -> None:
    page = refused([0.0, 1.0], [np.nan, 1.0])._repr_html_()
    assert "<b>No fit</b> (too_few_points)" in page
    assert "<li>Rows with a missing time or value take no part in the fit.</li>" in page


def test_the_library_loads_no_pandas_until_a_frame_is_asked_for() -> None:
    program = "import sys, estimators; estimators.fit_trend([], []); sys.exit('pandas' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", program], check=False).returncode == 0
