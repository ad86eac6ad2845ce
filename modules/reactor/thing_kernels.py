"""What time and echoes do to the belief about one thing: numba kernels, in place.

Every kernel takes the ``belief`` (3, speeds, columns) of :class:`modules.reactor.thing.Thing` and
the probability of a false echo, and returns what that probability becomes. A *row* is one
speed; a row that has no weight left is not touched any more. A *column* is a line or a pair.
"""

from __future__ import annotations

import math

from numba import njit

from modules.reactor.cone import Cones, Floats, heard_in_cone
from modules.reactor.meeting import BEHIND_M
from modules.reactor.thing import (
    COLUMNS,
    DISTANCE,
    LINE_PRIOR,
    LINES_M,
    PAIR_M,
    PAIRS_M,
    RADIUS_M,
    SINGLE,
    SPEEDS_M_S,
    STANDS_PRIOR,
    VARIANCE,
    WEIGHT,
    EchoModel,
)

DEAD = 1e-9
"""Weight of a row below which it is taken for impossible."""

GRAZING = 0.35
"""How uncertain the range of a cone that only grazes a thing is, as a share of what that range
is above the nearest point's: a line is some centimetres wide, and there the range is steep."""


@njit(cache=True)
def bear(
    belief: Floats,
    cones: Cones,
    cone: int,
    echo_m: float,
    sigma_m: float,
    lateral_m: float,
    model: EchoModel,
) -> float:
    """Fill in a thing of which one forward cone heard one echo."""
    walking = model.walks / (len(SPEEDS_M_S) - 1)
    for row in range(len(SPEEDS_M_S)):
        prior = model.stands if row == 0 else walking
        for column in range(COLUMNS):
            left = _nearest_m(column, lateral_m)
            ahead = math.sqrt(max((echo_m + RADIUS_M) ** 2 - left * left, 0.01))
            _, heard, _, _ = expected(ahead, column, lateral_m, cones, cone)
            on_line = STANDS_PRIOR[column] if row == 0 else LINE_PRIOR[column]
            belief[WEIGHT, row, column] = prior * on_line if heard else 0.0
            belief[DISTANCE, row, column] = ahead
            # Which part was heard is not known: up to a radius further off than the nearest.
            belief[VARIANCE, row, column] = sigma_m**2 + (RADIUS_M / 4) ** 2
    return weighed(belief, 1.0 - model.stands - model.walks)


@njit(cache=True)
def move(belief: Floats, driven_m: float, elapsed_s: float, model: EchoModel) -> float:
    """The thing after ``elapsed_s`` in which the robot drove ``driven_m`` forward."""
    changes = 1.0 - math.exp(-model.line_change_hz * elapsed_s)
    stays = math.exp(-model.leaves_hz * elapsed_s)
    real = 0.0
    for row in range(len(SPEEDS_M_S)):
        total = belief[WEIGHT, row].sum()
        if total == 0.0:
            continue
        walks = row > 0
        step = model.speed_step_m_s * elapsed_s if walks else 0.02 * min(elapsed_s, 1.0)
        mixed = total * changes if walks else 0.0
        kept = 1.0 - changes if walks else 1.0
        for column in range(COLUMNS):
            distance = belief[DISTANCE, row, column] - driven_m - SPEEDS_M_S[row] * elapsed_s
            weight = kept * belief[WEIGHT, row, column] + mixed * LINE_PRIOR[column]
            # Who has walked past is nowhere ahead any more; what stands is in the way of a robot
            # that returns to the centre line until it is clear of it.
            gone = distance < (-RADIUS_M if walks else -BEHIND_M)
            weight = 0.0 if gone else weight * stays
            belief[WEIGHT, row, column] = weight
            belief[DISTANCE, row, column] = distance
            belief[VARIANCE, row, column] += step * step
            real += weight
    return 1.0 - real


@njit(cache=True)
def listen(
    belief: Floats,
    false: float,
    cones: Cones,
    cone: int,
    echo_m: float,
    sigma_m: float,
    lateral_m: float,
    model: EchoModel,
) -> tuple[float, float]:
    """One transducer's echo, NaN for none; also how likely it was the thing's own."""
    if math.isnan(echo_m):
        return _silence(belief, false, cones, cone, lateral_m, model), 0.0
    own_weight = all_weight = 0.0
    other = model.stray / cones.farthest_m
    for row in range(len(SPEEDS_M_S)):
        if belief[WEIGHT, row].sum() == 0.0:
            continue
        for column in range(COLUMNS):
            ahead = belief[DISTANCE, row, column]
            range_m, heard, slope, blur = expected(ahead, column, lateral_m, cones, cone)
            weight = belief[WEIGHT, row, column]
            if not heard:
                belief[WEIGHT, row, column] = weight * other
                all_weight += weight * other
                continue
            spread = belief[VARIANCE, row, column]
            variance = slope * slope * spread + sigma_m * sigma_m + blur * blur
            off = echo_m - range_m
            density = math.exp(-0.5 * off * off / variance) / math.sqrt(2.0 * math.pi * variance)
            own = model.heard * density
            likelihood = own + model.masked / cones.farthest_m
            gain = own / likelihood * slope * spread / variance
            belief[WEIGHT, row, column] = weight * likelihood
            belief[DISTANCE, row, column] = ahead + gain * off
            belief[VARIANCE, row, column] = spread * (1.0 - gain * slope)
            own_weight += weight * own
            all_weight += weight * likelihood
    total = all_weight + false * other
    return weighed(belief, false * other), own_weight / total


@njit(cache=True)
def hide(
    belief: Floats,
    false: float,
    cones: Cones,
    cone: int,
    echo_m: float,
    sigma_m: float,
    lateral_m: float,
    model: EchoModel,
) -> float:
    """A transducer heard something else that is known to stand at ``echo_m``.

    What is behind it cannot be heard; what is before it should have been: the likelihood ratio
    is that of a missing echo, with a thing in the cone against none.
    """
    unexplained = (1.0 - model.heard - model.masked) / (1.0 - model.stray)
    for row in range(len(SPEEDS_M_S)):
        if belief[WEIGHT, row].sum() == 0.0:
            continue
        for column in range(COLUMNS):
            ahead = belief[DISTANCE, row, column]
            range_m, heard, _, _ = expected(ahead, column, lateral_m, cones, cone)
            spread = math.sqrt(sigma_m * sigma_m + belief[VARIANCE, row, column])
            if heard and range_m < echo_m - 3.0 * spread:
                belief[WEIGHT, row, column] *= unexplained
    return weighed(belief, false)


@njit(cache=True)
def _silence(
    belief: Floats, false: float, cones: Cones, cone: int, lateral_m: float, model: EchoModel
) -> float:
    """A transducer heard nothing."""
    missed, nothing = 1.0 - model.heard - model.masked, 1.0 - model.stray
    for row in range(len(SPEEDS_M_S)):
        if belief[WEIGHT, row].sum() == 0.0:
            continue
        for column in range(COLUMNS):
            ahead = belief[DISTANCE, row, column]
            _, heard, _, _ = expected(ahead, column, lateral_m, cones, cone)
            belief[WEIGHT, row, column] *= missed if heard else nothing
    return weighed(belief, false * nothing)


@njit(cache=True)
def expected(
    ahead_m: float, column: int, lateral_m: float, cones: Cones, cone: int
) -> tuple[float, bool, float, float]:
    """What a cone of a robot at ``lateral_m`` hears of a thing so far ahead.

    Range; whether it is heard; change of range with distance; how uncertain the range is because a
    line is not a point, a standard deviation. Of a pair the nearer that is heard.
    """
    if column < SINGLE:
        return _expected_of_one(ahead_m, LINES_M[column] - lateral_m, cones, cone)
    more = PAIRS_M[column - SINGLE]
    left = _expected_of_one(ahead_m + more[0], PAIR_M - lateral_m, cones, cone)
    right = _expected_of_one(ahead_m + more[1], -PAIR_M - lateral_m, cones, cone)
    if left[1] and (left[0] <= right[0] or not right[1]):
        return left
    return right


@njit(cache=True)
def _expected_of_one(
    ahead_m: float, left_m: float, cones: Cones, cone: int
) -> tuple[float, bool, float, float]:
    range_m, heard = heard_in_cone(ahead_m, left_m, RADIUS_M, cones.edges, cone)
    away = math.sqrt(ahead_m * ahead_m + left_m * left_m)
    slope = min(max(ahead_m / max(away, 1e-6), 0.0), 1.0)
    heard = heard and range_m < cones.farthest_m and ahead_m > 0.0
    return range_m, heard, slope, GRAZING * (range_m + RADIUS_M - away)


@njit(cache=True)
def _nearest_m(column: int, lateral_m: float) -> float:
    """How far left of the robot a thing is; of a pair the one that is less far beside it."""
    if column < SINGLE:
        left: float = LINES_M[column] - lateral_m
        return left
    return -PAIR_M - lateral_m if lateral_m < 0.0 else PAIR_M - lateral_m


@njit(cache=True)
def weighed(belief: Floats, false: float) -> float:
    """Make weights and the probability of a false echo sum to 1."""
    total = belief[WEIGHT].sum() + false
    for row in range(len(SPEEDS_M_S)):
        if belief[WEIGHT, row].sum() <= DEAD * total:
            belief[WEIGHT, row] = 0.0
        else:
            belief[WEIGHT, row] /= total
    share: float = false / total
    return share
