"""A labelled track, smoothed where one looks: :class:`Course`, from which labels and answers are made."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from estimators.arrays import FloatArray
from estimators.trajectories.labelling.modes import ENTRY, LEVEL_STRIDE, MISSING, REDRAW
from estimators.trajectories.methods.labelled import Labelled
from estimators.trajectories.rows import Rows
from estimators.trajectories.smoothing.blocks import BLOCK, Smoothing
from estimators.trajectories.smoothing.solved import Solved
from estimators.trajectories.smoothing.uncertainty import (
    HALF_S,
    Doubt,
    corrections,
    position_variance,
    share_of_doubt,
)

_MANY = 1 << 17
"""What a long track is like as a whole is told by so many of its rows."""


@dataclass(frozen=True, slots=True)
class View:
    """Rows on end, smoothed.

    Attributes
    ----------
    part : slice
    solved : Solved
    places : ndarray, shape (k, 2)
        In the plane.
    variance, residual : ndarray, shape (k,)
        Of the smoothed position per axis; distance of the fix from it.
    """

    part: slice
    solved: Solved
    places: FloatArray
    variance: FloatArray
    residual: FloatArray


class Course:
    """A labelled track, of which any rows can be looked at; only a few blocks of it are held.

    Parameters
    ----------
    rows : Rows
    labelled : Labelled
    block : int
        Rows of a block.
    """

    def __init__(self, rows: Rows, labelled: Labelled, block: int = BLOCK) -> None:
        self.rows, self.labelled = rows, labelled
        labels = np.full(rows.t.size, MISSING, dtype=np.uint8)
        labels[rows.measures] = labelled.labels
        self.labels = labels
        self._block = block
        self._smoothing = Smoothing(
            rows.t,
            rows.fixes,
            rows.reported,
            labels,
            labelled.parameters,
            rows.velocity,
            rows.velocity_variance,
            block,
        )
        self._doubt = self._find_doubt()

    def parts(self) -> Iterator[slice]:
        """Blocks of rows in order of time."""
        m = self.rows.t.size
        for first in range(0, m, self._block):
            yield slice(first, min(first + self._block, m))

    def around(self, part: slice, seconds: float) -> slice:
        """Rows, those of some seconds before and after them, and one more on either side."""
        t = self.rows.t
        first = int(np.searchsorted(t, t[part.start] - seconds))
        stop = int(np.searchsorted(t, t[part.stop - 1] + seconds, side="right"))
        return slice(max(min(first, part.start - 1), 0), min(max(stop, part.stop + 1), t.size))

    def view(self, part: slice) -> View:
        """Look at rows on end."""
        rows, wide = self.rows, part
        if self._doubt.share > 0.0:
            wide = self.around(part, HALF_S)
        solved = self._smoothing.rows(wide.start, wide.stop)
        variance = position_variance(
            rows.t[wide], rows.fixes[wide], solved, self.labelled.parameters.colour_m, self._doubt
        )
        own = slice(part.start - wide.start, part.stop - wide.start)
        solved = solved.part(own)
        places = np.ascontiguousarray(solved.states[:, :, 0])
        return View(part, solved, places, variance[own], np.hypot(*(rows.fixes[part] - places).T))

    def typical_sigma(self) -> FloatArray:
        """Take standard deviations per axis: of all rows, or of so many that tell, evenly spread."""
        stride = -(-self.rows.t.size // _MANY)
        found = [
            np.sqrt(self.view(part).variance[-part.start % stride :: stride])
            for part in reversed(list(self.parts()))
        ]
        return np.concatenate(found[::-1])

    def _find_doubt(self) -> Doubt:
        rows = self.rows
        beginnings = sum(
            int(np.count_nonzero(np.isin(self.labels[part] % LEVEL_STRIDE, (ENTRY, REDRAW))))
            for part in self.parts()
        )
        share = share_of_doubt(float(rows.t[-1] - rows.t[0]), beginnings)
        if share == 0.0:
            return Doubt(0.0, 0.0)
        found = []
        for part in reversed(list(self.parts())):
            squared = corrections(rows.fixes[part], self._smoothing.rows(part.start, part.stop))
            found.append(squared[squared > 0.0])
        return Doubt(share, float(np.median(np.concatenate(found))))
