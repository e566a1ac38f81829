"""How ``examples/disk_usage.csv`` was made: two weeks of a disk that fills, read once an hour.

The truth is a steady growth of 2.4 GB a day from 312 GB, read with a noise of 1 GB. On top of it comes what
every operator knows: each night a backup stages 12 to 22 GB for three hours, a service left in debug mode
writes most of a gigabyte of log an hour for a day and a half until the log is rotated away, the agent reads 0
a few times, and a few readings are missing. ``python -m examples.disk_usage`` writes the file again.
"""

from __future__ import annotations

import csv
import datetime as dt
import io
import math
from pathlib import Path

import numpy as np

FILE = Path(__file__).with_suffix(".csv")
START = dt.datetime(2025, 9, 1, tzinfo=dt.UTC)
HOURS = 14 * 24
FIRST_GB = 312.0
GROWTH_GB_PER_DAY = 2.4
NOISE_GB = 1.0


def simulate() -> list[tuple[str, float]]:
    """Rows of time (ISO 8601) and used gigabytes; NaN where the reading is missing."""
    # The legacy generator: its streams are frozen, so the file stays the same under every numpy.
    random = np.random.RandomState(20250901)
    hours = np.arange(HOURS)
    used = FIRST_GB + GROWTH_GB_PER_DAY * hours / 24 + NOISE_GB * random.standard_normal(HOURS)
    for day in range(14):
        begin = 24 * day + 2
        used[begin : begin + 3] += random.uniform(12, 22)
    debug = slice(24 * 10 + 9, 24 * 10 + 9 + 36)
    used[debug] += 0.8 * np.arange(1, 37)
    used[random.choice(HOURS, 4, replace=False)] = 0.0
    used[random.choice(HOURS, 5, replace=False)] = math.nan
    times = [(START + dt.timedelta(hours=int(hour))).strftime("%Y-%m-%dT%H:%M:%SZ") for hour in hours]
    return list(zip(times, used.tolist(), strict=True))


def to_csv(rows: list[tuple[str, float]]) -> str:
    """CSV text with the columns ``time`` and ``value`` (GB); an empty field where a reading is missing."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["time", "value"])
    writer.writerows((time, "" if math.isnan(value) else f"{value:.2f}") for time, value in rows)
    return text.getvalue()


if __name__ == "__main__":
    FILE.write_text(to_csv(simulate()))
