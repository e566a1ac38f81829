"""RTKLIB's ``rnx2rtkp``: single points with RAIM exclusion, from RINEX files that hold the faults.

The program reads files, so the faults are written into a station's observations: every code of a satellite is
lengthened by its bias at the epoch.
"""

from __future__ import annotations

import datetime
import gzip
import re
import resource
import shutil
import subprocess
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from benchmarks.positions.answers import Answer
from benchmarks.positions.faults import Faulty
from benchmarks.positions.sky import Station
from estimators.arrays import FloatArray

PROGRAM = "rnx2rtkp"
_SYSTEM_BITS = {"G": 1, "R": 4, "E": 8, "J": 16, "C": 32}
_WEEK_START = datetime.datetime(1980, 1, 6)  # GPS time, which no zone describes
_FIELD, _WIDTH, _FIRST = 16, 14, 3
_INDENT, _NUMBER = 4, 19
_INAV_CLOCK = 1 << 9
"""Of the data sources of a Galileo message: its clock is that of E1 with E5b (RINEX 3.05, table A8)."""
_CONFIGURATION = """pos1-posmode=single
pos1-elmask=10
pos1-navsys={systems}
pos1-ionoopt=brdc
pos1-tropopt=saas
pos1-sateph=brdc
pos1-posopt5=on
out-solformat=xyz
out-timesys=gpst
out-timeform=tow
out-outstat=residual
"""


def is_present() -> bool:
    """Whether the program is installed (Debian package ``rtklib``)."""
    return shutil.which(PROGRAM) is not None


def answer_by_rtklib(station: Station, data: Path, faulty: Sequence[Faulty]) -> tuple[list[Answer], float]:
    """Positions of a station's epochs; each epoch at most once.

    Parameters
    ----------
    station : Station
    data : pathlib.Path
        Folder of the stations.
    faulty : sequence of Faulty

    Returns
    -------
    answers : list of Answer
        Without a position where the program gives none: that is how it refuses an epoch.
    ms : float
        Processor time per epoch, reading the files included.
    """
    biases = {
        round(given.sky.time_s): dict(zip(given.sky.name, given.bias_m, strict=True)) for given in faulty
    }
    folder = data / station.folder
    observations = _lengthened(_text(folder / station.observations), biases)
    positions, used, seconds = _run(station.systems, observations, _text(folder / station.navigation))
    answers = []
    for given in faulty:
        at = round(given.sky.time_s)
        if at not in positions:
            answers.append(Answer(None, np.zeros(len(given.sky.name), dtype=np.bool_)))
        else:
            chosen = used.get(at, set())
            answers.append(Answer(positions[at], np.array([name in chosen for name in given.sky.name])))
    return answers, 1e3 * seconds / len(faulty)


def clean_positions(station: Station, data: Path, *, one_message: bool) -> dict[int, FloatArray]:
    """Positions of all epochs of a station, by second of the week.

    Parameters
    ----------
    station : Station
    data : pathlib.Path
        Folder of the stations.
    one_message : bool
        Whether to hand over Galileo's I/NAV messages alone. The program (2.4.3 b34) takes orbits and clocks
        from them, but the group delay from the first message of the satellite in the file, and F/NAV messages
        have none for E1 with E5b (its issue 785, https://github.com/tomojitakasu/RTKLIB/issues/785).
    """
    folder = data / station.folder
    navigation = _text(folder / station.navigation)
    given = _without_other_messages(navigation) if one_message else navigation
    return _run(station.systems, _text(folder / station.observations), given)[0]


def _run(
    systems: str, observations: str, navigation: str
) -> tuple[dict[int, FloatArray], dict[int, set[str]], float]:
    """Positions and the satellites used, by second of the week, and seconds of processor time."""
    with tempfile.TemporaryDirectory() as made:
        work = Path(made)
        files = work / "station.obs", work / "station.nav"
        for file, text in zip(files, (observations, navigation), strict=True):
            file.write_text(text, encoding="ascii")
        configuration = work / "single.conf"
        configuration.write_text(
            _CONFIGURATION.format(systems=sum(_SYSTEM_BITS[letter] for letter in systems)), encoding="ascii"
        )
        out = work / "out.pos"
        before = _child_seconds()
        subprocess.run(
            [PROGRAM, "-k", configuration, "-o", out, *files],
            check=True,
            capture_output=True,
        )
        seconds = _child_seconds() - before
        return _positions(out), _used(work / "out.pos.stat"), seconds


def _without_other_messages(navigation: str) -> str:
    """Leave out Galileo's messages (RINEX 3) but I/NAV."""
    header, _, body = navigation.partition("END OF HEADER")
    rest_of_line, _, body = body.partition("\n")
    records = re.split(r"\n(?=[A-Z])", body)
    kept = [record for record in records if not record.startswith("E") or _is_inav(record)]
    return f"{header}END OF HEADER{rest_of_line}\n" + "\n".join(kept)


def _is_inav(record: str) -> bool:
    sources = record.split("\n")[5][_INDENT + _NUMBER : _INDENT + 2 * _NUMBER]
    return bool(int(float(sources.replace("D", "E"))) & _INAV_CLOCK)


def _child_seconds() -> float:
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def _text(path: Path) -> str:
    opened = gzip.open if path.suffix == ".gz" else open
    with opened(path, "rt", encoding="ascii", errors="replace") as lines:
        return str(lines.read()).encode("ascii", "replace").decode("ascii")


def _lengthened(text: str, biases: Mapping[int, Mapping[str, float]]) -> str:
    """Observations (RINEX 3) at the given times of week only, codes lengthened."""
    header, _, body = text.partition("END OF HEADER")
    rest_of_line, _, body = body.partition("\n")
    columns = _code_columns(header)
    lines = [header + "END OF HEADER" + rest_of_line]
    current: Mapping[str, float] | None = None
    for line in body.splitlines():
        if line.startswith(">"):
            current = biases.get(_time_of_week(line))
        if current is None:
            continue
        bias = 0.0 if line.startswith(">") else current.get(line[:3].replace(" ", "0"), 0.0)
        lines.append(_with_bias(line, columns.get(line[0], ()), bias) if bias != 0.0 else line)
    return "\n".join(lines) + "\n"


def _with_bias(line: str, columns: Sequence[int], bias: float) -> str:
    for column in columns:
        start = _FIRST + _FIELD * column
        field = line[start : start + _WIDTH]
        if field.strip():
            line = f"{line[:start]}{float(field) + bias:{_WIDTH}.3f}{line[start + _WIDTH :]}"
    return line


def _time_of_week(line: str) -> int:
    year, month, day, hour, minute = (int(part) for part in line[1:].split()[:5])
    since = datetime.datetime(year, month, day, hour, minute) - _WEEK_START
    return round(since.total_seconds() % 604800 + float(line[1:].split()[5]))


def _code_columns(header: str) -> dict[str, tuple[int, ...]]:
    """Places of the pseudoranges among each system's observations."""
    kinds: dict[str, list[str]] = {}
    system = ""
    for line in header.splitlines():
        if line[60:].strip() == "SYS / # / OBS TYPES":
            system = line[0] if line[0] != " " else system
            kinds.setdefault(system, []).extend(line[7:60].split())
    return {
        letter: tuple(place for place, kind in enumerate(found) if kind.startswith("C"))
        for letter, found in kinds.items()
    }


def _positions(path: Path) -> dict[int, FloatArray]:
    found = {}
    for line in path.read_text(encoding="ascii").splitlines():
        parts = line.split()
        if parts and not line.startswith("%"):
            found[round(float(parts[1]))] = np.array([float(part) for part in parts[2:5]])
    return found


def _used(path: Path) -> dict[int, set[str]]:
    """Satellites of each solution: those with residuals."""
    found: dict[int, set[str]] = {}
    for line in path.read_text(encoding="ascii").splitlines():
        parts = line.split(",")
        if parts[0] == "$SAT":
            found.setdefault(round(float(parts[2])), set()).add(parts[3])
    return found
