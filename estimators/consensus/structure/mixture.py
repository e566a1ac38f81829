"""What a line leaves unexplained: a mixture with sticky labels along the time axis, fitted by EM.

A reading follows the line (a normal law of scale s) or is contaminated. Contaminated readings come as
uniform ones over the range of the values; as errors to one side or both (exponential and Gamma(2) with a
mean of at least 3 s); or as an excursion that keeps a level of its own while it lasts. Labels are sticky:
a two-state chain whose forward filter (Hamilton 1989) gives each reading's probability and the
likelihood of the series. A fresh excursion pays for its unknown level once, ln(range); a structure is
therefore judged by how often in time the readings leave it, and not only by how many do
(METHODS_TRENDS: "What *the trend* means").
"""

from __future__ import annotations

import math

from estimators.kernels import device

# Slots of a candidate's parameter vector.
LEVEL = 0
SLOPE = 1
SIGMA = 2
UNIFORM = 3  # share of uniform readings among the contaminated
ABOVE = 4  # share and mean of one-sided errors above and below
ABOVE_MEAN = 5
BELOW = 6
BELOW_MEAN = 7
HELD = 8  # share of contaminated readings that keep the level of their excursion
HELD_SCALE = 9
ENTER = 10  # P(contaminated | the last followed the line)
STAY = 11  # P(contaminated | the last was contaminated)
LIKELIHOOD = 12  # log-likelihood at the parameters before the last step
INLIERS = 13  # effective number of readings that follow the line
TIME_SPREAD = 14  # their sum of squared time deviations
HELD_COUNT = 15  # effective number of readings that keep the level of an excursion
SIZE = 16

_ROOT_2PI = 2.5066282746310002
_STUDENT5 = 0.3796066898224944  # density of Student's t with 5 degrees of freedom at 0
LEVEL_GAIN = 0.03
TAU_FLOOR = 0.5
SIDE_FLOOR = 3.0
SEPARATION = 6.0


@device
def start(t, y, root_weight, level, slope, scale, sigma_floor, fixed, params):
    """Initial parameters of a candidate, from labels cut at ``scale``: one pass without transcendentals."""
    n = t.size
    inside = 0
    square = 0.0
    entered = 1.0
    stayed = 1.0
    from_in = 2.0
    from_out = 2.0
    held = 1.0
    could_hold = 2.0
    was_out = False
    last = 0.0
    for i in range(n):
        r = (y[i] - level - slope * t[i]) * root_weight[i]
        out = abs(r) > scale
        if not out:
            inside += 1
            square += r * r
        if i > 0:
            if was_out:
                from_out += 1.0
                if out:
                    stayed += 1.0
                    could_hold += 1.0
                    if abs(r - last) <= 2.0 * scale:
                        held += 1.0
            else:
                from_in += 1.0
                if out:
                    entered += 1.0
        was_out = out
        last = r
    sigma = fixed if fixed > 0.0 else max(sigma_floor, math.sqrt(square / max(1, inside - 2)))
    params[LEVEL] = level
    params[SLOPE] = slope
    params[SIGMA] = sigma
    params[UNIFORM] = 0.6
    params[ABOVE] = 0.2
    params[BELOW] = 0.2
    params[ABOVE_MEAN] = 10.0 * sigma
    params[BELOW_MEAN] = 10.0 * sigma
    params[HELD] = held / could_hold
    params[HELD_SCALE] = 1.5 * sigma
    params[ENTER] = entered / from_in
    params[STAY] = stayed / from_out


@device
def side_scale(mean, s):
    """Scale of one-sided errors with a given mean: the root of mean = theta + c theta / (c + theta)."""
    c = SEPARATION * s
    half = 0.5 * (mean - 2.0 * c)
    return max(SIDE_FLOOR * s, half + math.sqrt(half * half + mean * c))


@device
def em_step(t, y, root_weight, spread, sides, sigma_floor, fixed, params):
    """One forward filter over the series and one update of all parameters, in place.

    ``sides``: 0 none, 1 above only, -1 below only, 2 both. ``spread`` is the range of the values;
    ``fixed`` a given noise scale, or 0.
    """
    n = t.size
    a = params[LEVEL]
    b = params[SLOPE]
    s = params[SIGMA]
    held_share = params[HELD]
    tau = params[HELD_SCALE]
    enter = params[ENTER]
    stay = params[STAY]
    uniform = params[UNIFORM] / spread
    above = params[ABOVE]
    below = params[BELOW]
    theta_up = params[ABOVE_MEAN]
    theta_down = params[BELOW_MEAN]
    narrow = 1.0 / (_ROOT_2PI * s)
    apart = SEPARATION * s
    above_height = above * (apart + theta_up) / (theta_up * theta_up)
    below_height = below * (apart + theta_down) / (theta_down * theta_down)
    log_likelihood = 0.0
    product = 1.0
    # Sufficient statistics of the M-step.
    w0 = 0.0
    w1 = 0.0
    w2 = 0.0
    wy = 0.0
    wty = 0.0
    wyy = 0.0
    inliers = 0.0
    q_uniform = 0.0
    q_above = 0.0
    q_below = 0.0
    r_above = 0.0
    r_below = 0.0
    q_held = 0.0
    q_fresh = 0.0
    r_held = 0.0
    from_in = 1e-9
    in_to_out = 0.0
    from_out = 1e-9
    out_to_out = 0.0
    previous = enter / (1.0 - stay + enter)  # stationary share of contaminated readings
    level = 0.0
    age = 0.0
    for i in range(n):
        root = root_weight[i]
        raw = y[i] - a - b * t[i]
        r = raw * root
        u = r / s
        f_in = narrow * math.exp(-0.5 * u * u) if abs(u) < 38.0 else 0.0
        g_uniform = uniform
        g_above = 0.0
        g_below = 0.0
        if r > 0.0:
            if above > 0.0:
                g_above = above_height * math.exp(-r / theta_up) * (1.0 - math.exp(-r / apart))
        elif below > 0.0:
            g_below = below_height * math.exp(r / theta_down) * (1.0 - math.exp(r / apart))
        g_side = g_above + g_below
        f_free = g_uniform + g_side
        f_held = 0.0
        tail = 0.0
        if age > 0.0:
            away = (r - level) / tau
            tail = 1.0 / (1.0 + 0.2 * away * away)
            f_held = _STUDENT5 / tau * tail * tail * tail
            f_out = (1.0 - held_share) * f_free + held_share * f_held
        else:
            f_out = f_free
        p_out = previous * stay + (1.0 - previous) * enter
        joint_in = (1.0 - p_out) * f_in
        joint_out = p_out * f_out
        total = joint_in + joint_out
        total = max(total, 1e-290)
        product *= total
        if product < 1e-200 or product > 1e200:
            log_likelihood += math.log(product)
            product = 1.0
        out = joint_out / total
        z = 1.0 - out
        # Transitions: posterior of the pair, by the filter.
        pair = previous * stay * f_out / total
        from_out += previous
        out_to_out += pair
        from_in += 1.0 - previous
        in_to_out += (1.0 - previous) * enter * f_out / total
        # The line.
        w = z * root * root
        w0 += w
        w1 += w * t[i]
        w2 += w * t[i] * t[i]
        wy += w * y[i]
        wty += w * t[i] * y[i]
        wyy += w * raw * raw
        inliers += z
        # The background.
        if f_out > 0.0:
            free = out
            if age > 0.0:
                held = out * held_share * f_held / f_out
                free = out - held
                q_held += held
                q_fresh += free
                r_held += held * 1.2 * tail * (r - level) * (r - level)
            if f_free > 0.0:
                q_uniform += free * g_uniform / f_free
                q_above += free * g_above / f_free
                q_below += free * g_below / f_free
                r_above += free * g_above / f_free * r
                r_below -= free * g_below / f_free * r
        # The level of the present excursion, forgotten once the series is back on the line.
        if out > 0.5:
            if age > 0.0 and abs(r - level) < 6.0 * tau:
                age += out
                gain = max(LEVEL_GAIN, 1.0 / age)
                level += gain * (r - level)
            else:
                level = r
                age = 1.0
        else:
            age = 0.0
        previous = out
    log_likelihood += math.log(product)
    params[LIKELIHOOD] = log_likelihood
    params[INLIERS] = inliers
    params[HELD_COUNT] = q_held
    if inliers < 2.5:
        params[LIKELIHOOD] = -1e300
        return
    mean_t = w1 / w0
    sxx = w2 - w1 * mean_t
    params[TIME_SPREAD] = sxx
    if sxx > 1e-12 * w0:
        slope = (wty - mean_t * wy) / sxx
        line_level = wy / w0 - slope * mean_t
        # Residual sum at the new line, from the old residuals: the step is small beside them.
        da = line_level - a
        db = slope - b
        residual = wyy - (da * da * w0 + 2.0 * da * db * w1 + db * db * w2)
        params[LEVEL] = line_level
        params[SLOPE] = slope
        if fixed <= 0.0:
            params[SIGMA] = max(sigma_floor, math.sqrt(max(0.0, residual) / inliers))
    s = params[SIGMA]
    free_total = q_uniform + q_above + q_below + 1.0
    if sides != 0:
        params[ABOVE] = 0.0 if sides == -1 else (q_above + 0.25) / free_total
        params[BELOW] = 0.0 if sides == 1 else (q_below + 0.25) / free_total
        params[UNIFORM] = 1.0 - params[ABOVE] - params[BELOW]
        params[ABOVE_MEAN] = side_scale(r_above / max(q_above, 1e-9), s)
        params[BELOW_MEAN] = side_scale(r_below / max(q_below, 1e-9), s)
    else:
        params[UNIFORM] = 1.0
        params[ABOVE] = 0.0
        params[BELOW] = 0.0
    params[HELD] = min(0.99, max(0.01, (q_held + 0.5) / (q_held + q_fresh + 1.0)))
    params[HELD_SCALE] = max(TAU_FLOOR * s, math.sqrt(r_held / max(q_held, 1e-9)))
    params[ENTER] = min(0.98, max(0.002, (in_to_out + 0.5) / (from_in + 1.0)))
    params[STAY] = min(0.995, max(0.02, (out_to_out + 0.5) / (from_out + 1.0)))
