"""Counter-based random numbers: a number is a function of (stream, round, index) and of nothing else.

Compiled selections draw their pivots from here; what they find does not depend on them, how long it takes
does (METHODS.md 13.8). The mixing function is the finaliser of SplitMix64 (Steele, Lea & Flood 2014).
"""

from __future__ import annotations

import numpy as np

from estimators.kernels import device

_GOLDEN = np.uint64(0x9E3779B97F4A7C15)
_FIRST = np.uint64(0xBF58476D1CE4E5B9)
_SECOND = np.uint64(0x94D049BB133111EB)
_S27, _S30, _S31, _S11 = np.uint64(27), np.uint64(30), np.uint64(31), np.uint64(11)
_TO_UNIT = 2.0**-53


@device
def mixed(counter: np.uint64) -> np.uint64:
    """64 well mixed bits of a counter."""
    bits = counter + _GOLDEN
    bits = (bits ^ (bits >> _S30)) * _FIRST
    bits = (bits ^ (bits >> _S27)) * _SECOND
    return bits ^ (bits >> _S31)


@device
def sequence_key(stream: int, round_: int) -> np.uint64:
    """Key of one of the sequences of a stream."""
    return mixed(mixed(np.uint64(stream)) + np.uint64(round_))


@device
def unit_uniform(key: np.uint64, index: int) -> float:
    """Uniform number in [0, 1) at ``index`` of a sequence."""
    return float(mixed(key + np.uint64(index)) >> _S11) * _TO_UNIT
