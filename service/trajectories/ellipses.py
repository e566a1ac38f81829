"""Error ellipses on the wire: they come whole, and instead of an accuracy.

Files of receivers may hold both; of these the accuracy counts, and the ellipse where a row has none. What a
caller sends or names is meant, so both together are a mistake.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import replace

from estimators.adapters.tracks.recording import Recording
from service.errors import invalid_value
from service.schemas.trajectories import COLUMN_PARAMETERS

AXES = ("ellipse_major_m", "ellipse_minor_m")
ELLIPSE = (*AXES, "ellipse_bearing_deg")
ACCURACY = "accuracy_m"


def check_ellipse(given: Collection[str], names: Mapping[str, str]) -> None:
    """Refuse an ellipse beside an accuracy, and one without its axes.

    Parameters
    ----------
    given : collection of str
        Columns that came, as a recording names them.
    names : mapping of str to str
        Their names on the wire.

    Raises
    ------
    Problem
        422, naming the column that is too much or missing.
    """
    refuse_both(given, names)
    if any(column in given for column in ELLIPSE):
        for axis in AXES:
            if axis not in given:
                beside = ", ".join(names[column] for column in ELLIPSE if column in given)
                raise invalid_value(names[axis], f"is needed beside {beside}: an ellipse has two axes")


def refuse_both(given: Collection[str], names: Mapping[str, str]) -> None:
    """Refuse an ellipse beside an accuracy, 422."""
    if ACCURACY in given and any(column in given for column in ELLIPSE):
        axes = " and ".join(names[axis] for axis in AXES)
        raise invalid_value(names[ACCURACY], f"comes beside an error ellipse; send it, or {axes}")


def named_ellipse(recording: Recording, columns: Mapping[str, str]) -> Recording:
    """Take a table at the ellipse that the caller named, and not at an accuracy that it holds too.

    Raises
    ------
    Problem
        422 if one axis was named, and the table has no column for the other or no numbers in one.
    """
    if not any(axis in columns for axis in AXES):
        return recording
    for axis in AXES:
        if getattr(recording, axis) is None:
            raise invalid_value(
                COLUMN_PARAMETERS[axis],
                "the table has no such axis with numbers; an ellipse has two, name the column of each",
            )
    return replace(recording, accuracy_m=None)
