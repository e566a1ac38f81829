"""One step of EM for a candidate: a forward filter over the series (Hamilton 1989), then all parameters anew.

What a reading's density needs of the other readings is little: the label before it and the level of the
present excursion. All else is computed before and after the filter, in loops that run over several readings
at once; only the filter itself goes one by one. Every sum has the order of the series.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from estimators.arrays import FloatArray
from estimators.consensus.structure.decay import decay
from estimators.consensus.structure.densities import fill_densities
from estimators.consensus.structure.mixture import (
    ABOVE,
    ABOVE_MEAN,
    BELOW,
    BELOW_MEAN,
    CORRELATION,
    ENTER,
    HELD,
    HELD_COUNT,
    HELD_SCALE,
    INLIERS,
    LEVEL,
    LEVEL_GAIN,
    LIKELIHOOD,
    ROOT_2PI,
    SIGMA,
    SLOPE,
    STAY,
    STUDENT5,
    TAU_FLOOR,
    TIME_SPREAD,
    UNIFORM,
    settle_correlation,
    settle_labels,
    side_scale,
)
from estimators.kernels import device

_LEAST_INLIERS = 2.5


class Filtered(NamedTuple):
    """What the filter sums up over the readings.

    Attributes
    ----------
    log_likelihood : float
    held, fresh, held_square : float
        Readings of an excursion that keep its level, those that do not, and the squares of the first.
    in_to_out, from_out, out_to_out : float
        Moves of the chain of labels.
    lagged, lag_square : float
        Product and square of neighbouring residuals that both follow the line.
    """

    log_likelihood: float
    held: float
    fresh: float
    held_square: float
    in_to_out: float
    from_out: float
    out_to_out: float
    lagged: float
    lag_square: float


@device
def em_step(
    t: FloatArray,
    y: FloatArray,
    root_weight: FloatArray,
    sides: int,
    sigma_floor: float,
    fixed: float,
    correlate: bool,
    params: FloatArray,
) -> None:
    """One forward filter over the series and one update of all parameters, in place.

    ``sides``: 0 none, 1 above only, -1 below only, 2 both. ``fixed``: a given noise scale, or 0.
    ``correlate``: whether to estimate the correlation of neighbours.
    """
    n = t.size
    residual = np.empty(n)
    f_follow = np.empty(n)
    g_side = np.empty(n)
    out = np.empty(n)
    free = np.empty(n)
    fill_densities(t, y, root_weight, params, residual, f_follow, g_side)
    filtered = _filter(root_weight, residual, f_follow, g_side, params, out, free)
    params[LIKELIHOOD] = filtered.log_likelihood
    params[HELD_COUNT] = filtered.held
    uniform = params[UNIFORM]
    inliers = _update_line(t, y, root_weight, sigma_floor, fixed, out, params)
    params[INLIERS] = inliers
    if inliers < _LEAST_INLIERS:
        params[LIKELIHOOD] = -1e300
        return
    if correlate:
        settle_correlation(filtered.lagged, filtered.lag_square, inliers, params)
    _update_free(residual, g_side, free, uniform, sides, params)
    held = filtered.held
    least = TAU_FLOOR * params[SIGMA]
    params[HELD_SCALE] = max(least, math.sqrt(filtered.held_square / max(held, 1e-9)))
    settle_labels(n, held, filtered.fresh, filtered.in_to_out, filtered.from_out, filtered.out_to_out, params)


@device
def _filter(
    root_weight: FloatArray,
    residual: FloatArray,
    f_follow: FloatArray,
    g_side: FloatArray,
    params: FloatArray,
    out: FloatArray,
    free: FloatArray,
) -> Filtered:
    """Fill ``out`` with the probability that a reading is contaminated, given it and those before.

    ``free`` times a density of contamination without a level is the probability of just that.
    """
    held_share, tau = params[HELD], params[HELD_SCALE]
    enter, stay = params[ENTER], params[STAY]
    uniform = params[UNIFORM]  # over the unit range of the values
    inverse_s = 1.0 / params[SIGMA]
    narrow = 1.0 / (ROOT_2PI * params[SIGMA])
    inverse_tau = 1.0 / tau
    held_height = STUDENT5 / tau
    rho = params[CORRELATION]
    log_likelihood = 0.0
    product = 1.0
    q_held = 0.0
    q_fresh = 0.0
    r_held = 0.0
    in_to_out = 0.0
    from_out = 1e-9
    out_to_out = 0.0
    lagged = 0.0
    lag_square = 0.0
    expected = 0.0  # of the residual, given the last one that followed the line
    known = 0.0  # share of its variance that is known
    last_at = -2
    last_inlier = 0.0
    previous = enter / (1.0 - stay + enter)  # stationary share of contaminated readings
    level = 0.0
    age = 0.0
    for i in range(residual.size):
        r = residual[i]
        if rho > 0.0:
            expected *= rho
            known *= rho * rho
            left = 1.0 / math.sqrt(1.0 - known)
            u = (r - expected) * inverse_s * left
            f_in = narrow * root_weight[i] * left * decay(0.5 * u * u)
        else:
            f_in = f_follow[i]
        f_free = uniform + g_side[i]
        f_held = 0.0
        tail = 0.0
        if age > 0.0:
            away = (r - level) * inverse_tau
            tail = 1.0 / (1.0 + 0.2 * away * away)
            f_held = held_height * root_weight[i] * tail * tail * tail
            f_out = (1.0 - held_share) * f_free + held_share * f_held
        else:
            f_out = f_free
        stayed = previous * stay
        entered = (1.0 - previous) * enter
        p_out = stayed + entered
        joint_out = p_out * f_out
        # Positive, since neither density falls to 0.
        total = (1.0 - p_out) * f_in + joint_out
        product *= total
        if product < 1e-200 or product > 1e200:
            log_likelihood += math.log(product)
            product = 1.0
        inverse = 1.0 / total
        now = joint_out * inverse
        out[i] = now
        # Transitions: posterior of the pair, by the filter.
        per_state = f_out * inverse
        from_out += previous
        out_to_out += stayed * per_state
        in_to_out += entered * per_state
        # The background: the share out / f_out goes to each of its parts.
        part = p_out * inverse
        if age > 0.0:
            held = part * held_share * f_held
            part *= 1.0 - held_share
            q_held += held
            q_fresh += now - held
            r_held += held * 1.2 * tail * (r - level) * (r - level)
        free[i] = part
        # The level of the present excursion, forgotten once the series is back on the line.
        if now > 0.5:
            if age > 0.0 and abs(r - level) < 6.0 * tau:
                age += now
                gain = max(LEVEL_GAIN, 1.0 / age)
                level += gain * (r - level)
            else:
                level = r
                age = 1.0
        else:
            age = 0.0
            if last_at == i - 1:
                lagged += r * last_inlier
                lag_square += 0.5 * (r * r + last_inlier * last_inlier)
            last_at = i
            last_inlier = r
            expected = r
            known = 1.0
        previous = now
    log_likelihood += math.log(product)
    return Filtered(
        log_likelihood, q_held, q_fresh, r_held, in_to_out, from_out, out_to_out, lagged, lag_square
    )


@device
def _update_line(
    t: FloatArray,
    y: FloatArray,
    root_weight: FloatArray,
    sigma_floor: float,
    fixed: float,
    out: FloatArray,
    params: FloatArray,
) -> float:
    """Fit level, slope and scale to the readings that follow the line; returns how many do.

    Where there are too few of them, or they share one time, the line stays as it was.
    """
    a, b = params[LEVEL], params[SLOPE]
    w0 = 0.0
    w1 = 0.0
    w2 = 0.0
    wy = 0.0
    wty = 0.0
    wyy = 0.0
    inliers = 0.0
    for i in range(t.size):
        root = root_weight[i]
        z = 1.0 - out[i]
        w = z * root * root
        raw = y[i] - a - b * t[i]
        w0 += w
        w1 += w * t[i]
        w2 += w * t[i] * t[i]
        wy += w * y[i]
        wty += w * t[i] * y[i]
        wyy += w * raw * raw
        inliers += z
    if inliers < _LEAST_INLIERS:
        return inliers
    mean_t = w1 / w0
    sxx = w2 - w1 * mean_t
    params[TIME_SPREAD] = sxx
    if sxx > 1e-12 * w0:
        slope = (wty - mean_t * wy) / sxx
        level = wy / w0 - slope * mean_t
        # Residual sum at the new line, from the old residuals: the step is small beside them.
        da = level - a
        db = slope - b
        square = wyy - (da * da * w0 + 2.0 * da * db * w1 + db * db * w2)
        params[LEVEL] = level
        params[SLOPE] = slope
        if fixed <= 0.0:
            params[SIGMA] = max(sigma_floor, math.sqrt(max(0.0, square) / inliers))
    return inliers


@device
def _update_free(
    residual: FloatArray, g_side: FloatArray, free: FloatArray, uniform: float, sides: int, params: FloatArray
) -> None:
    """Share contamination without a level out among uniform readings and errors to either side."""
    if sides == 0:
        params[UNIFORM] = 1.0
        params[ABOVE] = 0.0
        params[BELOW] = 0.0
        return
    q_uniform = 0.0
    q_side = 0.0
    q_above = 0.0
    r_side = 0.0
    r_above = 0.0
    for i in range(residual.size):
        is_above = 1.0 if residual[i] > 0.0 else 0.0
        distance = abs(residual[i])
        sided = free[i] * g_side[i]
        q_uniform += free[i] * uniform
        q_side += sided
        r_side += sided * distance
        sided *= is_above
        q_above += sided
        r_above += sided * distance
    q_below = q_side - q_above
    r_below = r_side - r_above
    total = q_uniform + q_side + 1.0
    s = params[SIGMA]
    params[ABOVE] = 0.0 if sides == -1 else (q_above + 0.25) / total
    params[BELOW] = 0.0 if sides == 1 else (q_below + 0.25) / total
    params[UNIFORM] = 1.0 - params[ABOVE] - params[BELOW]
    params[ABOVE_MEAN] = side_scale(r_above / max(q_above, 1e-9), s)
    params[BELOW_MEAN] = side_scale(r_below / max(q_below, 1e-9), s)
