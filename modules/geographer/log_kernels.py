"""The frontier passes in logarithms: for the most probable map, and where floats underflow."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from modules.geographer.frontier import START, Table

Floats = NDArray[np.float64]


@njit(cache=True)
def combine(a: float, b: float, best: bool) -> float:
    """log(exp(a) + exp(b)), or the larger of the two."""
    low, high = min(a, b), max(a, b)
    if best or low == -np.inf:
        return high
    total: float = high + np.log1p(np.exp(low - high))
    return total


@njit(cache=True)
def log_pull(
    weights: Floats, close: Table, idle: int, after: Floats, before: Floats, best: bool
) -> None:
    """Log weight of what may follow each state before an intersection."""
    joined = len(close)
    before[:] = -np.inf
    done = len(after) - 2
    before[done] = weights[0, 0] + after[done]
    for rest in range(idle):
        before[rest] = weights[0, 0] + after[rest]
    for leave in range(4):
        for rest in range(joined):
            follows = after[close[rest] if leave == 0 else idle + (leave - 1) * joined + rest]
            if follows == -np.inf:
                continue
            if leave > 0 and rest < idle:
                before[rest] = combine(before[rest], weights[0, leave] + follows, best)
            for code in range(1, 4):
                state = idle + (code - 1) * joined + rest
                before[state] = combine(before[state], weights[code, leave] + follows, best)


@njit(cache=True)
def log_backward(
    weights: Floats, enter: Table, close: Table, idle: int, after: Floats, best: bool
) -> float:
    """Fill `after` (steps, states) with logs; return the log total, or that of the best map."""
    steps, states = after.shape
    width = len(enter)
    before = np.empty(states)
    after[steps - 1, :] = -np.inf
    after[steps - 1, states - 2] = 0.0
    for step in range(steps - 1, -1, -1):
        column = step % width
        log_pull(weights[step], close[column], idle, after[step], before, best)
        if step > 0:
            for state in range(states):
                after[step - 1, state] = before[enter[column, state]]
    total: float = before[START]
    return total


@njit(cache=True)
def log_forward(
    weights: Floats, enter: Table, close: Table, idle: int, after: Floats, types: Floats
) -> None:
    """Fill `types` (steps, 4, 4) with the posterior, from `after` of the summing log pass.

    What is carried forward is the posterior probability of each state, which cannot
    underflow where it matters: each step's moves are weighed given all that follows.
    """
    steps, states = after.shape
    width = len(enter)
    joined = close.shape[1]
    before = np.zeros(states)
    follows = np.empty(states)
    reached = np.empty(states)
    before[START] = 1.0
    types[:] = 0.0
    for step in range(steps):
        w = weights[step]
        log_pull(w, close[step % width], idle, after[step], follows, False)
        reached[:] = 0.0
        for state in range(states - 1):
            if before[state] == 0.0:
                continue
            for leave in range(4):
                code, target = move(state, leave, close[step % width], idle, joined)
                share = np.exp(w[code, leave] + after[step, target] - follows[state])
                types[step, code, leave] += before[state] * share
                reached[target] += before[state] * share
        total = types[step].sum()
        types[step] /= total
        before[:] = 0.0
        arriving = enter[(step + 1) % width]
        for state in range(states):
            before[arriving[state]] += reached[state] / total


@njit(cache=True)
def move(state: int, leave: int, close: Table, idle: int, joined: int) -> tuple[int, int]:
    """The enter code of a state, and the state after an intersection left by a leave code."""
    done = idle + 3 * joined
    if state >= done:
        return 0, state if leave == 0 else done + 1
    code, rest = 0, state
    if state >= idle:
        code = 1 + (state - idle) // joined
        rest = (state - idle) % joined
    if leave > 0:
        return code, idle + (leave - 1) * joined + rest
    return code, close[rest] if code > 0 else state
