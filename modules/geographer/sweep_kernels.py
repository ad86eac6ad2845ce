"""The two passes of the frontier method, sum-product, in linear numbers scaled at each step.

Arrays: `weights` (steps, 4, 4) by step, enter code and leave code; `enter` and `close` as in
:class:`modules.geographer.frontier.Frontier`; `after` (steps, states) the weight of all that
may still follow, for each state after a step, each step scaled to at most 1.

Scaling keeps the greatest weights, but what is smallest may underflow and yet matter in the
end, when evidence of some places contradicts that of others by hundreds of orders of magnitude. So
each pass also carries a bound on what it may have lost, in its own scale: the backward pass
on any one entry (its matrices have row sums of at most `_gain`), the forward pass on the sum
of all (its matrices are the transposed ones). `lost` (steps,) are the backward bounds.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from modules.geographer.frontier import START, Table

Floats = NDArray[np.float64]

LEAST = np.finfo(np.float64).tiny
"""What one product may lose by underflow."""


@njit(cache=True)
def _gain(weights: Floats) -> float:
    """The most that one step can multiply a loss by."""
    gain = 0.0
    for code in range(4):
        gain = max(gain, weights[code].sum())
    return gain


@njit(cache=True)
def _pull(weights: Floats, close: Table, idle: int, after: Floats, before: Floats) -> None:
    """Weight of what may follow each state before an intersection, from that after it."""
    joined = len(close)
    w = weights
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
def backward(
    weights: Floats, enter: Table, close: Table, idle: int, after: Floats, lost: Floats
) -> float:
    """Fill `after` and `lost`; return the log of the total weight of all connected maps."""
    steps, states = after.shape
    width = len(enter)
    before = np.zeros(states)
    after[steps - 1, :] = 0.0
    after[steps - 1, states - 2] = 1.0
    lost[steps - 1] = 0.0
    log_mass = 0.0
    for step in range(steps - 1, 0, -1):
        column = step % width
        _pull(weights[step], close[column], idle, after[step], before)
        top = before.max()
        if top == 0.0:
            return -np.inf
        log_mass += np.log(top)
        lost[step - 1] = (_gain(weights[step]) * lost[step] + 4 * LEAST) / top + LEAST
        for state in range(states):
            after[step - 1, state] = before[enter[column, state]] / top
    _pull(weights[0], close[0], idle, after[0], before)
    return log_mass + np.log(before[START]) if before[START] > 0.0 else -np.inf


@njit(cache=True)
def _push(
    weights: Floats,
    close: Table,
    idle: int,
    before: Floats,
    after: Floats,
    reached: Floats,
    types: Floats,
) -> None:
    """Carry the weight `before` an intersection to `reached` after it; sum `types` (4, 4)."""
    joined = len(close)
    w = weights
    done = len(after) - 2
    for rest in range(idle):
        reached[rest] = w[0, 0] * before[rest]
        types[0, 0] += before[rest] * after[rest]
    reached[done] = w[0, 0] * before[done]
    types[0, 0] += before[done] * after[done]
    for rest in range(joined):
        free = before[rest] if rest < idle else 0.0
        south = before[idle + rest]
        west = before[idle + joined + rest]
        both = before[idle + 2 * joined + rest]
        closed = close[rest]
        reached[closed] += w[1, 0] * south + w[2, 0] * west + w[3, 0] * both
        types[1, 0] += south * after[closed]
        types[2, 0] += west * after[closed]
        types[3, 0] += both * after[closed]
        for code in range(1, 4):
            state = idle + (code - 1) * joined + rest
            reached[state] = (
                w[0, code] * free + w[1, code] * south + w[2, code] * west + w[3, code] * both
            )
            types[0, code] += free * after[state]
            types[1, code] += south * after[state]
            types[2, code] += west * after[state]
            types[3, code] += both * after[state]
    reached[done + 1] = 0.0


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
    before = np.zeros(states)
    reached = np.zeros(states)
    before[START] = 1.0
    missing = 0.0
    error = 0.0
    types[:] = 0.0
    for step in range(steps):
        column = step % width
        _push(weights[step], close[column], idle, before, after[step], reached, types[step])
        types[step] *= weights[step]
        total = types[step].sum()
        mass = reached.sum()
        if total == 0.0 or mass == 0.0:
            return np.inf
        gain = _gain(weights[step])
        error = max(error, gain * (missing + lost[step] + states * LEAST) / total)
        missing = (gain * missing + 4 * states * LEAST) / mass + states * LEAST
        types[step] /= total
        before[:] = 0.0
        arriving = enter[(step + 1) % width]
        for state in range(states - 1):
            before[arriving[state]] += reached[state] / mass
    return error
