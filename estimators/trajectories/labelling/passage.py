"""A beam's way along a track of any length: :class:`Passage`.

What has to be kept is what the hypotheses do not agree on yet: the last fixes. The pieces in which a track is
handed over change nothing, not a bit of the answer.
"""

from __future__ import annotations

import numpy as np

from estimators.arrays import FloatArray
from estimators.trajectories.labelling.beam import FIRST, HOPELESS, OPEN, WIDTH, label_piece
from estimators.trajectories.labelling.state import COLUMNS
from estimators.trajectories.parameters import TrackParameters


class Passage:
    """Labels of a track that comes in pieces.

    Parameters
    ----------
    size : int
        Fixes of the whole track.
    parameters : TrackParameters
    lag : int
        Fixes after which the probability of a fix is settled; 0: no probabilities.
    width : int
        Hypotheses that are followed, at most 127.
    hopeless : float
        A branch exp(-hopeless) times as likely as the best is not followed.
    top_speed : float
        m/s.

    Attributes
    ----------
    labels : ndarray of uint8, shape (size,)
        See :mod:`estimators.trajectories.labelling.modes`; complete after the last piece.
    probability : ndarray, shape (size,)
        Of each fix to be good; empty without a lag.
    evidence : float
        Log likelihood after the last piece.

    Examples
    --------
    >>> import numpy as np
    >>> passage = Passage(3, TrackParameters(4.0, 1.0, 1.0))
    >>> noise, velocities = np.full(2, 16.0), (np.zeros((2, 2)), np.full(2, np.inf))
    >>> passage.follow(np.arange(2.0), np.zeros((2, 2)), noise, *velocities)
    >>> passage.follow(np.array([1.0, 2.0]), np.zeros((2, 2)), noise, *velocities, is_last=True)
    >>> passage.labels.tolist()
    [0, 0, 0]
    """

    def __init__(
        self,
        size: int,
        parameters: TrackParameters,
        lag: int = 0,
        width: int = WIDTH,
        hopeless: float = HOPELESS,
        top_speed: float = np.inf,
    ) -> None:
        self.labels = np.zeros(size, dtype=np.uint8)
        self.probability: FloatArray = np.ones(size if lag else 0)
        self.evidence = 0.0
        self._parameters, self._rates = parameters, parameters.rates.as_array()
        self._lag, self._width, self._hopeless, self._top_speed = lag, width, hopeless, top_speed
        room = max(width, FIRST)
        self._states = np.zeros((room, COLUMNS))
        self._mode, self._age = np.zeros(room, dtype=np.int64), np.zeros(room)
        self._weight, self._good = np.zeros(room), np.ones((room, max(lag, 1)))
        self._course = np.zeros(3, dtype=np.int64)
        self._parent = np.zeros((0, room), dtype=np.uint8)
        self._kind_of = np.zeros((0, room), dtype=np.uint8)

    def follow(
        self,
        t: FloatArray,
        fixes: FloatArray,
        variance: FloatArray,
        velocity: FloatArray,
        velocity_variance: FloatArray,
        *,
        is_last: bool = False,
    ) -> None:
        """Take in a piece.

        Parameters
        ----------
        t : ndarray, shape (n,)
            Seconds. Of every piece but the first, the first row is the last of the one before.
        fixes : ndarray, shape (n, 2)
            East and north, metres.
        variance : ndarray, shape (n,)
            Of white noise, per axis.
        velocity : ndarray, shape (n, 2)
            Reported, east and north, m/s.
        velocity_variance : ndarray, shape (n,)
            Per axis; infinite where there is none.
        is_last : bool
        """
        self._make_room(int(self._course[OPEN]) + t.size)
        self.evidence = label_piece(
            t,
            fixes,
            variance,
            velocity,
            velocity_variance,
            self._parameters.colour_m,
            self._parameters.manoeuvre,
            self._rates,
            self._lag,
            self._width,
            self._hopeless,
            self._top_speed,
            self.evidence,
            is_last,
            self._states,
            self._mode,
            self._age,
            self._weight,
            self._good,
            self._course,
            self._parent,
            self._kind_of,
            self.labels,
            self.probability,
        )

    def _make_room(self, rows: int) -> None:
        have, room = self._parent.shape
        if rows <= have:
            return
        more = np.zeros((max(rows - have, have), room), dtype=np.uint8)
        self._parent = np.concatenate([self._parent, more])
        self._kind_of = np.concatenate([self._kind_of, more])
