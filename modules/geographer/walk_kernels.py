"""Walks through the frontier's states, one map each: drawn, most probable, or given."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from modules.geographer.frontier import START, Table
from modules.geographer.log_kernels import move

Floats = NDArray[np.float64]
Maps = NDArray[np.uint8]


@njit(cache=True)
def _drawn(shares: Floats, at: float) -> int:
    """The entry that the fraction `at` of the total falls on."""
    left = at * shares.sum()
    chosen = 0
    for entry in range(len(shares)):
        if shares[entry] > 0.0:
            chosen = entry
            left -= shares[entry]
            if left < 0.0:
                break
    return chosen


@njit(cache=True)
def draw(
    weights: Floats,
    enter: Table,
    close: Table,
    idle: int,
    after: Floats,
    logarithmic: bool,
    uniforms: Floats,
    leaves: Maps,
) -> None:
    """Fill `leaves` (maps, steps) with leave codes drawn from the posterior.

    `uniforms` (maps, steps) are in [0, 1); `weights` and `after` are logs if `logarithmic`.
    """
    maps, steps = leaves.shape
    width, joined = close.shape
    shares = np.empty(4)
    for m in range(maps):
        state = START
        for step in range(steps):
            for leave in range(4):
                code, target = move(state, leave, close[step % width], idle, joined)
                if logarithmic:
                    shares[leave] = weights[step, code, leave] + after[step, target]
                else:
                    shares[leave] = weights[step, code, leave] * after[step, target]
            if logarithmic:
                shares[:] = np.exp(shares - shares.max())
            leave = _drawn(shares, uniforms[m, step])
            leaves[m, step] = leave
            code, target = move(state, leave, close[step % width], idle, joined)
            state = enter[(step + 1) % width, target]


@njit(cache=True)
def follow_best(
    weights: Floats, enter: Table, close: Table, idle: int, after: Floats, leaves: Maps
) -> None:
    """Fill `leaves` (1, steps) with the most probable map's leave codes, from the best log pass.

    Of equally probable maps, that with the smaller leave code at the first difference.
    """
    steps = leaves.shape[1]
    width, joined = close.shape
    state = START
    for step in range(steps):
        best = -np.inf
        following = state
        for leave in range(4):
            code, target = move(state, leave, close[step % width], idle, joined)
            value = weights[step, code, leave] + after[step, target]
            if value > best:
                best = value
                leaves[0, step] = leave
                following = target
        state = enter[(step + 1) % width, following]


@njit(cache=True)
def weigh(weights: Floats, enter: Table, close: Table, idle: int, leaves: Maps) -> Floats:
    """Log weight (maps,) of maps given as leave codes (maps, steps); -inf if not connected."""
    maps, steps = leaves.shape
    width, joined = close.shape
    result = np.zeros(maps)
    for m in range(maps):
        state = START
        for step in range(steps):
            leave = int(leaves[m, step])
            code, target = move(state, leave, close[step % width], idle, joined)
            result[m] += weights[step, code, leave]
            state = enter[(step + 1) % width, target]
        if state != idle + 3 * joined:
            result[m] = -np.inf
    return result
