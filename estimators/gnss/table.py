"""Epochs as one table: a row per satellite and epoch, and where each epoch begins."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from estimators.arrays import BoolArray, FloatArray, IntArray


@dataclass(frozen=True, slots=True)
class EpochTable:
    """Checked pseudoranges of one or many epochs, ready for the solver.

    Attributes
    ----------
    satellites_m : ndarray of float64, shape (rows, 3)
        Earth-centred, Earth-fixed.
    pseudoranges_m : ndarray of float64, shape (rows,)
        Corrected for satellite clock and atmosphere.
    sigma_m : ndarray of float64, shape (rows,)
        Noise; up to a factor that is estimated.
    clock : ndarray of int64, shape (rows,)
        Which of the epoch's receiver clocks the satellite shares.
    offsets : ndarray of int64, shape (epochs + 1,)
        Epoch k is rows ``offsets[k]:offsets[k + 1]``.
    letters : tuple of tuple of str
        Per epoch, the systems whose clocks are unknowns (:data:`estimators.gnss.systems.SYSTEMS`).
    names : tuple of str
        Per row, the satellite.
    rotated : bool
        Whether satellite positions are in the frame of the time of reception.
    """

    satellites_m: FloatArray
    pseudoranges_m: FloatArray
    sigma_m: FloatArray
    clock: IntArray
    offsets: IntArray
    letters: tuple[tuple[str, ...], ...]
    names: tuple[str, ...]
    rotated: bool

    def __len__(self) -> int:
        return self.offsets.size - 1

    def epoch(self, k: int) -> EpochTable:
        """One epoch as a table of its own."""
        rows = slice(int(self.offsets[k]), int(self.offsets[k + 1]))
        return EpochTable(
            satellites_m=self.satellites_m[rows],
            pseudoranges_m=self.pseudoranges_m[rows],
            sigma_m=self.sigma_m[rows],
            clock=self.clock[rows],
            offsets=np.array([0, rows.stop - rows.start], dtype=np.int64),
            letters=(self.letters[k],),
            names=self.names[rows],
            rotated=self.rotated,
        )

    def without(self, left_out: BoolArray) -> EpochTable:
        """Leave rows out; a system that has none left in an epoch has no clock there.

        Parameters
        ----------
        left_out : ndarray of bool, shape (rows,)
        """
        parts = [~left_out[a:b] for a, b in zip(self.offsets[:-1], self.offsets[1:], strict=True)]
        letters, clock = [], []
        for k, kept in enumerate(parts):
            old = self.clock[self.offsets[k] : self.offsets[k + 1]][kept]
            present, index = np.unique(old, return_inverse=True)
            letters.append(tuple(self.letters[k][j] for j in present))
            clock.append(index.astype(np.int64))
        kept_rows = np.concatenate(parts) if parts else np.zeros(0, dtype=np.bool_)
        return EpochTable(
            satellites_m=np.ascontiguousarray(self.satellites_m[kept_rows]),
            pseudoranges_m=self.pseudoranges_m[kept_rows],
            sigma_m=self.sigma_m[kept_rows],
            clock=np.concatenate(clock) if clock else np.zeros(0, dtype=np.int64),
            offsets=np.concatenate([[0], np.cumsum([int(kept.sum()) for kept in parts])]).astype(np.int64),
            letters=tuple(letters),
            names=tuple(name for name, kept in zip(self.names, kept_rows, strict=True) if kept),
            rotated=self.rotated,
        )
