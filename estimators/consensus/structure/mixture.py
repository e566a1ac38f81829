"""What a line leaves unexplained: a mixture with sticky labels along the time axis, fitted by EM.

A reading follows the line (a normal law of scale s) or is contaminated. Contaminated readings come as
uniform ones over the range of the values; as errors to one side or both, whose density is 0 at the line and
falls off exponentially (the sum of two exponential laws); or as an excursion that keeps a level of its own
while it lasts. Readings that follow the line may be correlated with their neighbours. Labels are sticky:
a two-state chain whose forward filter (Hamilton 1989) gives each reading's probability and the
likelihood of the series. A fresh excursion pays for its unknown level once, ln(range); a structure is
therefore judged by how often in time the readings leave it, and not only by how many do
(METHODS_TRENDS: "What *the trend* means").
"""

from __future__ import annotations

import math

from estimators.arrays import FloatArray
from estimators.consensus.structure.decay import decay
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
CORRELATION = 16  # of successive residuals of readings that follow the line
SIZE = 17

_ROOT_2PI = 2.5066282746310002
_ROOT_2PI_E = 4.132731354122493  # root of 2 pi e: a normal law's entropy is its logarithm
_HELD_WIDTH = 4.0  # width of an excursion's level in the hard labels' likelihood, in their scale
_STUDENT5 = 0.3796066898224944  # density of Student's t with 5 degrees of freedom at 0

LEVEL_GAIN = 0.03
"""Least gain with which the level of an excursion is followed: slow, so that it means something."""
TAU_FLOOR = 0.5
"""Least scale of readings about an excursion's level, in noise scales; it may be finer than the line's."""
SIDE_FLOOR = 5.0
"""Least scale of one-sided errors, in noise scales: a broad line may not call its own tail errors."""
SEPARATION = 11.0
"""Scale on which the density of one-sided errors rises from 0 at the line, in noise scales.

Errors stand apart from the noise; this is the dial that tells the edge of a one-sided cloud from its middle.
"""
CORRELATION_FLOOR = 2.0
"""Correlations below this many standard errors, 1 / sqrt(n), count as none."""


@device
def _chain(moved: float, all_of_them: float) -> float:
    """Log-likelihood of a two-state chain's moves from one state, at their own frequency."""
    stayed = all_of_them - moved
    value = 0.0
    if moved > 0.0:
        value += moved * math.log(moved / all_of_them)
    if stayed > 0.0:
        value += stayed * math.log(stayed / all_of_them)
    return value


@device
def start(
    t: FloatArray,
    y: FloatArray,
    root_weight: FloatArray,
    level: float,
    slope: float,
    scale: float,
    sigma_floor: float,
    fixed: float,
    params: FloatArray,
) -> None:
    """Set the parameters of a candidate from labels cut at ``scale``: one pass without transcendentals.

    The likelihood is that of the hard labels, good enough to tell which candidates deserve a better one.
    """
    n = t.size
    inside = 0.0
    square = 0.0
    outside_twice = 0.0
    held = 0.0
    was_out = 0.0
    last = 0.0
    # Flags are numbers here: branches that follow random outliers cost more than the arithmetic.
    for i in range(n):
        r = (y[i] - level - slope * t[i]) * root_weight[i]
        out = 1.0 if abs(r) > scale else 0.0
        square += (1.0 - out) * r * r
        inside += 1.0 - out
        both = out * was_out
        outside_twice += both
        held += both if abs(r - last) <= 2.0 * scale else 0.0
        was_out = out
        last = r
    outside = n - inside
    first_out = 1.0 if abs(y[0] - level - slope * t[0]) * root_weight[0] > scale else 0.0
    # Of n - 1 pairs of neighbours: how often an outlier was entered and how often it went on.
    from_out = outside - was_out
    entered = outside - first_out - outside_twice
    sigma = fixed if fixed > 0.0 else max(sigma_floor, math.sqrt(square / max(1.0, inside - 2.0)))
    params[LEVEL] = level
    params[SLOPE] = slope
    params[SIGMA] = sigma
    params[UNIFORM] = 0.6
    params[ABOVE] = 0.2
    params[BELOW] = 0.2
    params[ABOVE_MEAN] = 10.0 * sigma
    params[BELOW_MEAN] = 10.0 * sigma
    params[HELD] = (1.0 + held) / (2.0 + outside_twice)
    params[HELD_SCALE] = 1.5 * sigma
    params[ENTER] = (1.0 + entered) / (2.0 + n - 1.0 - from_out)
    params[STAY] = (1.0 + outside_twice) / (2.0 + from_out)
    params[INLIERS] = inside
    params[HELD_COUNT] = held
    params[TIME_SPREAD] = inside / 3.0  # as if spread evenly over [-1, 1]
    params[LIKELIHOOD] = (
        -inside * math.log(sigma * _ROOT_2PI_E)
        - held * math.log(_HELD_WIDTH * scale)
        + _chain(entered, n - 1.0 - from_out)
        + _chain(outside_twice, from_out)
    )


@device
def side_scale(mean: float, s: float) -> float:
    """Scale of one-sided errors with a given mean: the root of mean = theta + c theta / (c + theta)."""
    c = SEPARATION * s
    half = 0.5 * (mean - 2.0 * c)
    return max(SIDE_FLOOR * s, half + math.sqrt(half * half + mean * c))


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
    a = params[LEVEL]
    b = params[SLOPE]
    s = params[SIGMA]
    held_share = params[HELD]
    tau = params[HELD_SCALE]
    enter = params[ENTER]
    stay = params[STAY]
    uniform = params[UNIFORM]  # over the unit range of the values
    above = params[ABOVE]
    below = params[BELOW]
    theta_up = params[ABOVE_MEAN]
    theta_down = params[BELOW_MEAN]
    narrow = 1.0 / (_ROOT_2PI * s)
    apart = SEPARATION * s
    above_height = above * (apart + theta_up) / (theta_up * theta_up)
    below_height = below * (apart + theta_down) / (theta_down * theta_down)
    above_rate = 1.0 / theta_up
    below_rate = 1.0 / theta_down
    inverse_apart = 1.0 / apart
    inverse_s = 1.0 / s
    inverse_tau = 1.0 / tau
    held_height = _STUDENT5 / tau
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
    q_side = 0.0
    r_above = 0.0
    r_side = 0.0
    q_held = 0.0
    q_fresh = 0.0
    r_held = 0.0
    in_to_out = 0.0
    from_out = 1e-9
    out_to_out = 0.0
    rho = params[CORRELATION]
    lagged = 0.0
    lag_square = 0.0
    expected = 0.0  # of the residual, given the last one that followed the line
    known = 0.0  # share of its variance that is known
    last_at = -2
    last_inlier = 0.0
    previous = enter / (1.0 - stay + enter)  # stationary share of contaminated readings
    level = 0.0
    age = 0.0
    for i in range(n):
        root = root_weight[i]
        raw = y[i] - a - b * t[i]
        r = raw * root
        # Densities of whitened residuals times the root of the weight are densities of the values.
        if rho > 0.0:
            expected *= rho
            known *= rho * rho
            left = 1.0 / math.sqrt(1.0 - known)
            u = (r - expected) * inverse_s * left
            f_in = narrow * root * left * decay(0.5 * u * u)
        else:
            u = r * inverse_s
            f_in = narrow * root * decay(0.5 * u * u)
        # One-sided errors above or below, whichever side the reading is on.
        is_above = 1.0 if r > 0.0 else 0.0
        distance = abs(r)
        height = below_height + is_above * (above_height - below_height)
        rate = below_rate + is_above * (above_rate - below_rate)
        g_side = height * root * decay(distance * rate) * (1.0 - decay(distance * inverse_apart))
        f_free = uniform + g_side
        f_held = 0.0
        tail = 0.0
        if age > 0.0:
            away = (r - level) * inverse_tau
            tail = 1.0 / (1.0 + 0.2 * away * away)
            f_held = held_height * root * tail * tail * tail
            f_out = (1.0 - held_share) * f_free + held_share * f_held
        else:
            f_out = f_free
        p_out = previous * stay + (1.0 - previous) * enter
        joint_out = p_out * f_out
        # Positive, since neither density falls to 0.
        total = (1.0 - p_out) * f_in + joint_out
        product *= total
        if product < 1e-200 or product > 1e200:
            log_likelihood += math.log(product)
            product = 1.0
        inverse = 1.0 / total
        out = joint_out * inverse
        z = 1.0 - out
        # Transitions: posterior of the pair, by the filter.
        per_state = f_out * inverse
        from_out += previous
        out_to_out += previous * stay * per_state
        in_to_out += (1.0 - previous) * enter * per_state
        # The line.
        w = z * root * root
        w0 += w
        w1 += w * t[i]
        w2 += w * t[i] * t[i]
        wy += w * y[i]
        wty += w * t[i] * y[i]
        wyy += w * raw * raw
        inliers += z
        # The background: the share out / f_out goes to each of its parts.
        part = p_out * inverse
        free = part
        if age > 0.0:
            held = part * held_share * f_held
            free = part * (1.0 - held_share)
            q_held += held
            q_fresh += out - held
            r_held += held * 1.2 * tail * (r - level) * (r - level)
        q_uniform += free * uniform
        sided = free * g_side
        q_side += sided
        r_side += sided * distance
        sided *= is_above
        q_above += sided
        r_above += sided * distance
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
            if last_at == i - 1:
                lagged += r * last_inlier
                lag_square += 0.5 * (r * r + last_inlier * last_inlier)
            last_at = i
            last_inlier = r
            expected = r
            known = 1.0
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
    if correlate and lag_square > 0.0:
        rho = lagged / lag_square
        params[CORRELATION] = min(rho, 0.97) if rho > CORRELATION_FLOOR / math.sqrt(inliers) else 0.0
    s = params[SIGMA]
    q_below = q_side - q_above
    r_below = r_side - r_above
    free_total = q_uniform + q_side + 1.0
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
    params[ENTER] = min(0.98, max(0.002, (in_to_out + 0.5) / (n - from_out + 1.0)))
    params[STAY] = min(0.995, max(0.02, (out_to_out + 0.5) / (from_out + 1.0)))
