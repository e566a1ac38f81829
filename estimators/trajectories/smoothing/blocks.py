"""A labelled track smoothed block by block: :class:`Smoothing`.

The filter runs through once and leaves its state at the beginning of every block. From there a block is
filtered again and smoothed when it is asked for, from the last to the first, then in any order, since the
smoothed state at the end of every block is kept too. The answer is that of the whole to the bit, and what is
held is a few blocks.
"""

from __future__ import annotations

import numpy as np

from estimators.arrays import CodeArray, FloatArray
from estimators.consensus.cancellation import stop_if_cancelled
from estimators.trajectories.labelling.modes import ADRIFT, LEVEL_STRIDE, MISSING, SPIKE
from estimators.trajectories.parameters import TrackParameters
from estimators.trajectories.projected import Projected
from estimators.trajectories.smoothing.rts import begin, smooth_piece
from estimators.trajectories.smoothing.solved import Solved

BLOCK = 1 << 16
"""Rows of a block; some 30 MB while it is worked on."""
_HELD = 3
_NOTHING, _NOTHING_P = np.zeros((0, 2, 3)), np.zeros((0, 3, 3))


class Smoothing:
    """Smoothed states of a track, for any of its rows.

    Parameters
    ----------
    t : ndarray, shape (m,)
        Seconds, ascending.
    fixes : Projected
        East and north, metres, of any rows.
    reported : ndarray, shape (m,), or None
        Radii that hold 68 % as the receiver reports them.
    labels : ndarray of uint8, shape (m,)
        ``MISSING`` where nothing was measured.
    parameters : TrackParameters
    velocity : ndarray, shape (m, 2), or None
        Reported, east and north, m/s.
    velocity_variance : ndarray, shape (m,), or None
        Per axis; infinite where there is no velocity to be trusted.
    block : int
        Rows of a block.
    """

    def __init__(
        self,
        t: FloatArray,
        fixes: Projected,
        reported: FloatArray | None,
        labels: CodeArray,
        parameters: TrackParameters,
        velocity: FloatArray | None = None,
        velocity_variance: FloatArray | None = None,
        block: int = BLOCK,
    ) -> None:
        self.block = block
        self.blocks = -(-t.size // block)
        self._t, self._fixes, self._reported, self._labels = t, fixes, reported, labels
        self._parameters = parameters
        self._velocity, self._velocity_variance = velocity, velocity_variance
        self._begins: list[tuple[FloatArray, int]] = []
        # Smoothed states of first rows; of what comes behind the last block there is none.
        self._firsts: dict[int, tuple[FloatArray, FloatArray]] = {}
        self._solved: dict[int, Solved] = {}
        self._filter()

    def rows(self, first: int, stop: int) -> Solved:
        """Smoothed states of rows on end.

        Parameters
        ----------
        first, stop : int
            The latter is not included.
        """
        parts = []
        for number in range(first // self.block, -(-stop // self.block)):
            start = number * self.block
            solved = self._one(number)
            parts.append(solved.part(slice(max(first - start, 0), stop - start)))
        return parts[0] if len(parts) == 1 else Solved.joined(parts)

    def _one(self, number: int) -> Solved:
        if number not in self._solved:
            behind = min((place for place in self._firsts if place > number), default=self.blocks)
            for place in range(behind - 1, number - 1, -1):
                solved = self._smooth(place)
                self._firsts[place] = solved.states[0].copy(), solved.covariances[0].copy()
                self._keep(place, solved)
        return self._solved[number]

    def _keep(self, number: int, solved: Solved) -> None:
        """Hold a block, and let go of the one farthest from it."""
        self._solved[number] = solved
        if len(self._solved) > _HELD:
            del self._solved[max(self._solved, key=lambda place: abs(place - number))]

    def _piece(self, number: int, *, with_next: bool) -> slice:
        """Rows of a block, the row before and the row behind it."""
        first, stop = number * self.block, (number + 1) * self.block
        return slice(max(first - 1, 0), min(stop + 1 if with_next else stop, self._t.size))

    def _variance(self, part: slice) -> FloatArray:
        unit = np.ones(self._t[part].size) if self._reported is None else self._reported[part]
        return np.ascontiguousarray((self._parameters.sigma * unit) ** 2)

    def _velocities(self, part: slice) -> tuple[FloatArray, FloatArray]:
        """Velocities and their variances; infinite ones where there are none."""
        if self._velocity is None or self._velocity_variance is None:
            size = self._t[part].size
            return np.zeros((size, 2)), np.full(size, np.inf)
        return self._velocity[part], self._velocity_variance[part]

    def _filter(self) -> None:
        kind = self._labels % LEVEL_STRIDE
        told = (kind != SPIKE) & (kind != MISSING) & (kind != ADRIFT)
        # A track of nothing but faults begins at the last of its rows.
        first = int(np.argmax(told)) if told.any() else self._t.size - 1
        east, north = self._fixes[first : first + 1][0].tolist()
        state = begin(east, north, self._parameters.colour_m)
        lasting = 0
        for number in range(self.blocks):
            self._begins.append((state.copy(), lasting))
            if number + 1 < self.blocks:
                part = self._piece(number, with_next=False)
                lasting = self._run(
                    part, self._variance(part), state, lasting, number == 0, False, _NOTHING, _NOTHING_P
                )

    def _smooth(self, number: int) -> Solved:
        part = self._piece(number, with_next=True)
        variance = self._variance(part)
        size = variance.size
        states, covariances = np.zeros((size, 2, 3)), np.zeros((size, 3, 3))
        is_last = number + 1 == self.blocks
        if not is_last:
            states[-1], covariances[-1] = self._firsts[number + 1]
        state, lasting = self._begins[number]
        self._run(part, variance, state.copy(), lasting, number == 0, is_last, states, covariances)
        own = slice(number * self.block - part.start, (number + 1) * self.block - part.start)
        return Solved(self._labels[part], variance, states, covariances).part(own)

    def _run(
        self,
        part: slice,
        variance: FloatArray,
        state: FloatArray,
        lasting: int,
        is_first: bool,
        is_last: bool,
        states: FloatArray,
        covariances: FloatArray,
    ) -> int:
        stop_if_cancelled()
        parameters = self._parameters
        return smooth_piece(
            self._t[part],
            self._fixes[part],
            variance,
            *self._velocities(part),
            parameters.colour_m,
            parameters.manoeuvre,
            parameters.rates.as_array(),
            self._labels[part],
            state,
            lasting,
            is_first,
            is_last,
            states,
            covariances,
        )
