"""What a model of any number of columns leaves unexplained: the line's mixture, seen from its residuals.

The same mixture with sticky labels as in :mod:`estimators.consensus.structure.mixture` (a forward filter,
Hamilton 1989; readings that follow the model, uniform or one-sided errors, excursions with a level of their
own), but of residuals alone: what the model is made of does not matter here. Parameters stand in the
mixture's slots; those of the line, LEVEL and SLOPE, are not used.
"""

from __future__ import annotations

import math

from estimators.arrays import FloatArray
from estimators.consensus.structure.decay import decay
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
    LEVEL_GAIN,
    LIKELIHOOD,
    ROOT_2PI,
    SEPARATION,
    SIGMA,
    STAY,
    STUDENT5,
    TAU_FLOOR,
    UNIFORM,
    settle_correlation,
    settle_labels,
    side_scale,
)
from estimators.kernels import device

_LEAST_INLIERS = 2.5


@device
def start_mixture(sigma: float, enter: float, stay: float, params: FloatArray) -> None:
    """Set the parameters of a candidate of scale ``sigma`` before anything else is known of it."""
    params[:] = 0.0
    params[SIGMA] = sigma
    params[UNIFORM] = 0.6
    params[ABOVE] = 0.2
    params[BELOW] = 0.2
    params[ABOVE_MEAN] = 10.0 * sigma
    params[BELOW_MEAN] = 10.0 * sigma
    params[HELD] = 0.25
    params[HELD_SCALE] = 1.5 * sigma
    params[ENTER] = enter
    params[STAY] = stay


@device
def filter_step(
    residual: FloatArray,
    root_weight: FloatArray,
    sides: int,
    sigma_floor: float,
    correlate: bool,
    frozen: bool,
    params: FloatArray,
    weight: FloatArray,
) -> bool:
    """One forward filter over the residuals; updates the parameters of the background, in place.

    ``weight`` receives the weight of each reading for the next fit of the model; the scale is left to that.
    ``sides``: 0 none, 1 above only, -1 below only, 2 both. ``frozen`` keeps the chance of contamination as it
    is. Returns whether enough readings follow the model.
    """
    n = residual.size
    s = params[SIGMA]
    held_share, tau = params[HELD], params[HELD_SCALE]
    enter, stay = params[ENTER], params[STAY]
    uniform, above, below = params[UNIFORM], params[ABOVE], params[BELOW]
    theta_up, theta_down = params[ABOVE_MEAN], params[BELOW_MEAN]
    narrow = 1.0 / (ROOT_2PI * s)
    apart = SEPARATION * s
    log_likelihood = 0.0
    product = 1.0
    inliers = q_uniform = q_above = q_below = r_above = r_below = 0.0
    q_held = q_fresh = r_held = 0.0
    in_to_out = out_to_out = 0.0
    from_out = 1e-9
    rho = params[CORRELATION]
    lagged = lag_square = expected = known = 0.0
    last_at = -2
    last_inlier = 0.0
    previous = enter / (1.0 - stay + enter)
    level = age = 0.0
    for i in range(n):
        root = root_weight[i]
        r = residual[i] * root
        # Densities of whitened residuals times the root of the weight are densities of the values.
        # What the last reading that followed the model tells of this one; nothing without correlation.
        expected *= rho
        known *= rho * rho
        left = 1.0 / math.sqrt(1.0 - known)
        u = (r - expected) * left / s
        f_in = narrow * root * left * decay(0.5 * u * u)
        distance = abs(r)
        mean = theta_up if r > 0.0 else theta_down
        share = above if r > 0.0 else below
        g_side = share * (apart + mean) / (mean * mean) * root
        g_side *= decay(distance / mean) * (1.0 - decay(distance / apart))
        f_free = uniform + g_side
        f_held = tail = 0.0
        f_out = f_free
        if age > 0.0:
            away = (r - level) / tau
            tail = 1.0 / (1.0 + 0.2 * away * away)
            f_held = STUDENT5 / tau * root * tail * tail * tail
            f_out = (1.0 - held_share) * f_free + held_share * f_held
        p_out = previous * stay + (1.0 - previous) * enter
        joint_out = p_out * f_out
        total = (1.0 - p_out) * f_in + joint_out
        product *= total
        if product < 1e-200 or product > 1e200:
            log_likelihood += math.log(product)
            product = 1.0
        out = joint_out / total
        z = 1.0 - out
        per_state = f_out / total
        from_out += previous
        out_to_out += previous * stay * per_state
        in_to_out += (1.0 - previous) * enter * per_state
        weight[i] = z * root * root
        inliers += z
        part = p_out / total
        free = part
        if age > 0.0:
            held = part * held_share * f_held
            free = part * (1.0 - held_share)
            q_held += held
            q_fresh += out - held
            r_held += held * 1.2 * tail * (r - level) * (r - level)
        q_uniform += free * uniform
        if r > 0.0:
            q_above += free * g_side
            r_above += free * g_side * distance
        else:
            q_below += free * g_side
            r_below += free * g_side * distance
        # The level of the present excursion, forgotten once the series is back on the model.
        if out > 0.5:
            if age > 0.0 and abs(r - level) < 6.0 * tau:
                age += out
                level += max(LEVEL_GAIN, 1.0 / age) * (r - level)
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
        previous = out
    params[LIKELIHOOD] = log_likelihood + math.log(product)
    params[INLIERS] = inliers
    params[HELD_COUNT] = q_held
    if inliers < _LEAST_INLIERS:
        return False
    if correlate:
        settle_correlation(lagged, lag_square, inliers, params)
    if frozen:
        return True
    free_total = q_uniform + q_above + q_below + 1.0
    params[ABOVE] = (q_above + 0.25) / free_total if sides in (1, 2) else 0.0
    params[BELOW] = (q_below + 0.25) / free_total if sides in (-1, 2) else 0.0
    params[UNIFORM] = 1.0 - params[ABOVE] - params[BELOW]
    params[ABOVE_MEAN] = side_scale(r_above / max(q_above, 1e-9), s)
    params[BELOW_MEAN] = side_scale(r_below / max(q_below, 1e-9), s)
    params[HELD_SCALE] = max(TAU_FLOOR * max(s, sigma_floor), math.sqrt(r_held / max(q_held, 1e-9)))
    settle_labels(n, q_held, q_fresh, in_to_out, from_out, out_to_out, params)
    return True
