"""The two passes of the frontier method, sum-product, in linear numbers scaled at each step.

Arrays: `weights` (steps, 4, 4) by step, enter code and leave code; `enter` and `close` as in
:class:`modules.geographer.frontier.Frontier`; `after` (steps, states) the weight of all that
may still follow, for each state after a step, each step scaled to at most 1.

Scaling keeps the greatest weights, but what is smallest may underflow and yet matter in the
end, when evidence of some places contradicts that of others by hundreds of orders of magnitude. So
each pass also carries a bound on what it may have lost, in its own scale: the backward pass
on any one entry (its matrices have row sums of at most `_gain`), the forward pass on the sum
of all (its matrices are the transposed ones). `lost` (steps,) are the backward bounds, `missing`
a forward one; `before` (states,) is the weight that reaches each state before a step, scaled to a
sum of 1.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from modules.geographer.frontier import START, Table

Floats = NDArray[np.float64]

LEAST = float(np.finfo(np.float64).tiny)
"""What one product may lose by underflow."""


@njit(cache=True)
def _gain(weights: Floats) -> float:
    """The most that one step can multiply a loss by."""
    gain = 0.0
    for code in range(4):
        gain = max(gain, weights[code].sum())
    return gain


@njit(cache=True)
def pull(weights: Floats, close: Table, idle: int, after: Floats, before: Floats) -> None:
    """Weight of what may follow each state before an intersection, from that after it."""
    joined = len(close)
    w = weights
    before[len(after) - 1] = 0.0
    for rest in range(joined):
        none = after[close[rest]]
        north = after[idle + rest]
        east = after[idle + joined + rest]
        both = after[idle + 2 * joined + rest]
        for code in range(1, 4):
            before[idle + (code - 1) * joined + rest] = (
                w[code, 0] * none + w[code, 1] * north + w[code, 2] * east + w[code, 3] * both
            )
        if rest < idle:
            before[rest] = w[0, 0] * after[rest] + w[0, 1] * north + w[0, 2] * east + w[0, 3] * both
    done = len(after) - 2
    before[done] = w[0, 0] * after[done]


@njit(cache=True)
def pull_step(
    weights: Floats,
    enter: Table,
    close: Table,
    idle: int,
    after: Floats,
    lost: float,
    scratch: Floats,
    earlier: Floats,
) -> tuple[float, float]:
    """Fill `earlier`, what follows each state after the step before, from that `after` a step.

    `enter` and `close` are this step's rows. Returns the factor divided out (0 if no map is left)
    and the bound on what `earlier` has lost.
    """
    pull(weights, close, idle, after, scratch)
    top = scratch.max()
    if top == 0.0:
        return 0.0, np.inf
    for state in range(len(earlier)):
        earlier[state] = scratch[enter[state]] / top
    return float(top), (_gain(weights) * lost + 4 * LEAST) / top + LEAST


@njit(cache=True)
def backward(
    weights: Floats, enter: Table, close: Table, idle: int, after: Floats, lost: Floats
) -> float:
    """Fill `after` and `lost`; return the log of the total weight of all connected maps."""
    steps, states = after.shape
    width = len(enter)
    scratch = np.zeros(states)
    after[steps - 1, :] = 0.0
    after[steps - 1, states - 2] = 1.0
    lost[steps - 1] = 0.0
    log_mass = 0.0
    for step in range(steps - 1, 0, -1):
        x = step % width
        top, lost[step - 1] = pull_step(
            weights[step], enter[x], close[x], idle, after[step], lost[step], scratch,
            after[step - 1],
        )  # fmt: skip
        if top == 0.0:
            return -np.inf
        log_mass += np.log(top)
    pull(weights[0], close[0], idle, after[0], scratch)
    return log_mass + np.log(scratch[START]) if scratch[START] > 0.0 else -np.inf


@njit(cache=True)
def push(weights: Floats, close: Table, idle: int, before: Floats, reached: Floats) -> None:
    """Carry the weight `before` an intersection to `reached` after it."""
    joined = len(close)
    w = weights
    done = len(before) - 2
    for rest in range(idle):
        reached[rest] = w[0, 0] * before[rest]
    reached[done] = w[0, 0] * before[done]
    reached[done + 1] = 0.0
    for rest in range(joined):
        free = before[rest] if rest < idle else 0.0
        south = before[idle + rest]
        west = before[idle + joined + rest]
        both = before[idle + 2 * joined + rest]
        reached[close[rest]] += w[1, 0] * south + w[2, 0] * west + w[3, 0] * both
        for code in range(1, 4):
            reached[idle + (code - 1) * joined + rest] = (
                w[0, code] * free + w[1, code] * south + w[2, code] * west + w[3, code] * both
            )


@njit(cache=True)
def push_step(
    weights: Floats,
    arriving: Table,
    close: Table,
    idle: int,
    before: Floats,
    missing: float,
    scratch: Floats,
    later: Floats,
) -> float:
    """Fill `later`, the weight before the next step, from that `before` this one.

    `close` is this step's row, `arriving` the next step's row of `enter`. Returns the bound on
    what `later` has lost, infinite where no weight is left.
    """
    states = len(before)
    push(weights, close, idle, before, scratch)
    mass = scratch.sum()
    if mass == 0.0:
        return np.inf
    later[:] = 0.0
    for state in range(states - 1):
        later[arriving[state]] += scratch[state] / mass
    left_out: float = (_gain(weights) * missing + 4 * states * LEAST) / mass
    return left_out + states * LEAST


@njit(cache=True)
def types_of(
    weights: Floats, close: Table, idle: int, before: Floats, after: Floats, types: Floats
) -> None:
    """Fill `types` (4, 4) with a step's weight by enter and leave code."""
    joined = len(close)
    done = len(before) - 2
    types[:] = 0.0
    none = before[done] * after[done]
    for rest in range(idle):
        none += before[rest] * after[rest]
    types[0, 0] = none
    for rest in range(joined):
        free = before[rest] if rest < idle else 0.0
        south = before[idle + rest]
        west = before[idle + joined + rest]
        both = before[idle + 2 * joined + rest]
        closed = after[close[rest]]
        types[1, 0] += south * closed
        types[2, 0] += west * closed
        types[3, 0] += both * closed
        for code in range(1, 4):
            follows = after[idle + (code - 1) * joined + rest]
            types[0, code] += free * follows
            types[1, code] += south * follows
            types[2, code] += west * follows
            types[3, code] += both * follows
    types *= weights


@njit(cache=True)
def types_step(
    weights: Floats,
    close: Table,
    idle: int,
    before: Floats,
    missing: float,
    after: Floats,
    lost: float,
    types: Floats,
) -> float:
    """Fill `types` (4, 4) with a step's posterior; return a bound on its error by underflow."""
    types_of(weights, close, idle, before, after, types)
    total = types.sum()
    if total == 0.0:
        return np.inf
    types /= total
    error: float = _gain(weights) * (missing + lost + len(before) * LEAST) / total
    return error


@njit(cache=True)
def forward(
    weights: Floats,
    enter: Table,
    close: Table,
    idle: int,
    after: Floats,
    lost: Floats,
    types: Floats,
) -> float:
    """Fill `types` (steps, 4, 4) with the posterior; return a bound on its error by underflow."""
    steps, states = after.shape
    width = len(enter)
    scratch = np.zeros(states)
    before = np.zeros(states)
    later = np.zeros(states)
    before[START] = 1.0
    missing = 0.0
    error = 0.0
    for step in range(steps):
        x = step % width
        wrong = types_step(
            weights[step], close[x], idle, before, missing, after[step], lost[step], types[step]
        )
        error = max(error, wrong)
        if error == np.inf:
            break
        missing = push_step(
            weights[step], enter[(x + 1) % width], close[x], idle, before, missing, scratch, later
        )
        before, later = later, before
    return error
