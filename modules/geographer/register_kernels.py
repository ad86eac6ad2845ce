"""The frontier passes with registers: one step each, in linear numbers or in logarithms.

Arrays: `before` (states, labels, counts) and `after` (states, later labels, later counts) by state
of the frontier and by register value (:mod:`modules.geographer.registers`); `weights` (labels, 4,
4) by label, enter and leave code, `moves` (labels, 4, 4) the later label. If not `counting`, there
is one count. Scaling and bounds are as in :mod:`modules.geographer.sweep_kernels`.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from modules.geographer.frontier import Table
from modules.geographer.log_kernels import combine, move

Floats = NDArray[np.float64]
Labels = NDArray[np.int64]
Maps = NDArray[np.uint8]


@njit(cache=True)
def added(leave: int, counting: bool) -> int:
    """How many corridors a leave code adds to the count."""
    return (leave & 1) + (leave >> 1) if counting else 0


@njit(cache=True)
def met(turn: int, idle: int, joined: int) -> tuple[int, int]:
    """The state and enter code that a pass meets at a turn, or -1 at some.

    The four states of one rest follow each other, because they lead to the same states.
    """
    rest, code = divmod(turn, 4)
    if rest == joined:
        return idle + 3 * joined, 0
    if code == 0:
        return (rest if rest < idle else -1), 0
    return idle + (code - 1) * joined + rest, code


@njit(cache=True)
def _dot(given: Floats, follows: Floats, more: int, n: int) -> float:
    """The sum of given[i] follows[i + more] for i < n, in four interleaved parts for speed."""
    a = b = c = d = 0.0
    whole = n - n % 4
    for i in range(0, whole, 4):
        a += given[i] * follows[i + more]
        b += given[i + 1] * follows[i + more + 1]
        c += given[i + 2] * follows[i + more + 2]
        d += given[i + 3] * follows[i + more + 3]
    for i in range(whole, n):
        a += given[i] * follows[i + more]
    return (a + b) + (c + d)


@njit(cache=True)
def pull(
    weights: Floats,
    moves: Labels,
    close: Table,
    idle: int,
    counting: bool,
    after: Floats,
    before: Floats,
) -> None:
    """Fill `before` with the weight of what may follow."""
    states, labels, counts = before.shape
    before[:] = 0.0
    for turn in range(4 * len(close) + 1):
        state, code = met(turn, idle, len(close))
        if state < 0:
            continue
        for leave in range(4):
            target = move(state, leave, close, idle, len(close))[1]
            more = added(leave, counting)
            if target == states - 1:
                continue
            for label in range(labels):
                w = weights[label, code, leave]
                if w == 0.0:
                    continue
                total = before[state, label]
                follows = after[target, moves[label, code, leave]]
                for n in range(min(counts, len(follows) - more)):
                    total[n] += w * follows[n + more]


@njit(cache=True)
def log_pull(
    weights: Floats,
    moves: Labels,
    close: Table,
    idle: int,
    counting: bool,
    after: Floats,
    before: Floats,
    best: bool,
) -> None:
    """Like :func:`pull` with logs; the maximum in place of the sum if `best`."""
    states, labels, counts = before.shape
    before[:] = -np.inf
    for turn in range(4 * len(close) + 1):
        state, code = met(turn, idle, len(close))
        if state < 0:
            continue
        for leave in range(4):
            target = move(state, leave, close, idle, len(close))[1]
            more = added(leave, counting)
            if target == states - 1:
                continue
            for label in range(labels):
                w = weights[label, code, leave]
                if w == -np.inf:
                    continue
                total = before[state, label]
                follows = after[target, moves[label, code, leave]]
                for n in range(min(counts, len(follows) - more)):
                    total[n] = combine(total[n], w + follows[n + more], best)


@njit(cache=True)
def push(
    weights: Floats,
    moves: Labels,
    close: Table,
    idle: int,
    counting: bool,
    before: Floats,
    after: Floats,
    reached: Floats,
    types: Floats,
) -> None:
    """Carry `before` on to `reached`; fill `types` (labels, 4, 4), not yet divided by their sum."""
    states, labels, counts = before.shape
    reached[:] = 0.0
    types[:] = 0.0
    for turn in range(4 * len(close) + 1):
        state, code = met(turn, idle, len(close))
        if state < 0:
            continue
        for leave in range(4):
            target = move(state, leave, close, idle, len(close))[1]
            more = added(leave, counting)
            if target == states - 1:
                continue
            for label in range(labels):
                w = weights[label, code, leave]
                if w == 0.0:
                    continue
                later = moves[label, code, leave]
                given = before[state, label]
                follows = after[target, later]
                total = reached[target, later]
                inside = min(counts, len(follows) - more)
                types[label, code, leave] += w * _dot(given, follows, more, inside)
                for n in range(inside):
                    total[n + more] += w * given[n]


@njit(cache=True)
def log_push(
    weights: Floats,
    moves: Labels,
    close: Table,
    idle: int,
    counting: bool,
    before: Floats,
    here: Floats,
    after: Floats,
    reached: Floats,
    types: Floats,
) -> None:
    """Like :func:`push`, of posterior probabilities; `here` and `after` are logs of what follows.

    `here` belongs to the states before the step, as :func:`log_pull` has it.
    """
    states, labels, counts = before.shape
    reached[:] = 0.0
    types[:] = 0.0
    for turn in range(4 * len(close) + 1):
        state, code = met(turn, idle, len(close))
        if state < 0:
            continue
        for leave in range(4):
            target = move(state, leave, close, idle, len(close))[1]
            more = added(leave, counting)
            if target == states - 1:
                continue
            for label in range(labels):
                later = moves[label, code, leave]
                follows = after[target, later]
                for n in range(min(counts, len(follows) - more)):
                    given = before[state, label, n]
                    if given == 0.0:
                        continue
                    log_share = weights[label, code, leave] + follows[n + more]
                    share = given * np.exp(log_share - here[state, label, n])
                    reached[target, later, n + more] += share
                    types[label, code, leave] += share


@njit(cache=True)
def gather(arriving: Table, before: Floats, divisor: float, after: Floats) -> None:
    """Fill `after` a step with what follows the states `before` the next one, divided."""
    states, labels, counts = after.shape
    for state in range(states):
        for label in range(labels):
            for n in range(counts):
                after[state, label, n] = before[arriving[state], label, n] / divisor


@njit(cache=True)
def scatter(arriving: Table, reached: Floats, divisor: float, before: Floats) -> None:
    """Add what `reached` the states after a step to the states before the next one, divided."""
    states, labels, counts = reached.shape
    before[:] = 0.0
    for state in range(states - 1):
        for label in range(labels):
            for n in range(counts):
                before[arriving[state], label, n] += reached[state, label, n] / divisor


@njit(cache=True)
def walk(
    weights: Floats,
    moves: Labels,
    close: Table,
    idle: int,
    counting: bool,
    arriving: Table,
    after: Floats,
    logarithmic: bool,
    uniforms: Floats,
    places: Labels,
    leaves: Maps,
) -> None:
    """One step of several walks: fill `leaves` (maps,), move `places` (maps, 3) on.

    A place is a state, label and count. `weights` are logs, `after` too if `logarithmic`. A walk
    goes where the fraction `uniforms` (maps,) of the total falls; if negative, the best way.
    """
    shares = np.empty(4)
    for m in range(len(leaves)):
        state, label, count = places[m]
        for leave in range(4):
            code, target = move(state, leave, close, idle, len(close))
            n = count + added(leave, counting)
            shares[leave] = -np.inf
            if n < after.shape[2]:
                follows = after[target, moves[label, code, leave], n]
                if not logarithmic:
                    follows = np.log(follows)
                shares[leave] = weights[label, code, leave] + follows
        chosen = int(np.argmax(shares))
        if uniforms[m] >= 0.0:
            odds = np.exp(shares - shares[chosen])
            left = uniforms[m] * odds.sum()
            for leave in range(4):
                if odds[leave] > 0.0:
                    chosen = leave
                    left -= odds[leave]
                    if left < 0.0:
                        break
        leaves[m] = chosen
        code, target = move(state, chosen, close, idle, len(close))
        places[m, 0] = arriving[target]
        places[m, 1] = moves[label, code, chosen]
        places[m, 2] = count + added(chosen, counting)
