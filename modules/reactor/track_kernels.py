"""A whole scan taken in: every thing ahead after every forward echo, as numba kernels.

Things are two arrays: ``beliefs`` (things, 3, speeds, columns) and ``notes`` (things, 5), oldest
first. ``echoes`` (cones, 2) are the mean range, NaN for none, and its standard deviation.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from modules.reactor.cone import Cones, Floats
from modules.reactor.thing import DISTANCE, SHAPE, WEIGHT, EchoModel
from modules.reactor.thing_kernels import bear, hide, listen, move

MOST_THINGS = 6

FALSE, PINGS, FIRST_S, APPROACHING, STANDS_AT_M = range(5)
"""Columns of ``notes``: probability of a false echo; pings that explained it; when it was first
heard; probability that it walks towards the robot; how far ahead if it stands, inf if it
certainly does not."""
NOTES = 5

SETTLED = 0.95
"""Probability from which a thing counts as known to stand, or to walk."""

WALKS = 0.5
"""Probability from which a thing is taken for a walker when it is compared with others."""

GONE = 0.9995
"""Probability of a false echo from which a thing is dropped."""

SAME_M = 0.45
"""New echoes no further apart than this are of one new thing (a radius and the noise)."""


@njit(cache=True)
def scanned(
    beliefs: Floats,
    notes: Floats,
    cones: Cones,
    echoes: Floats,
    time_s: float,
    elapsed_s: float,
    driven_m: float,
    lateral_m: float,
    model: EchoModel,
) -> tuple[Floats, Floats, int]:
    """The things after a scan, and how many table entries that touched."""
    known = len(notes)
    after = np.empty((known + len(echoes), SHAPE[0], SHAPE[1], SHAPE[2]))
    noted = np.empty((known + len(echoes), NOTES))
    after[:known] = beliefs
    noted[:known] = notes
    for k in range(known):
        noted[k, FALSE] = move(after[k], driven_m, elapsed_s, model)
    explained = _heard(after[:known], noted[:known], cones, echoes, lateral_m, model)
    count = _add_new(after, noted, known, cones, echoes, explained, time_s, lateral_m, model)
    cells = len(echoes)
    for k in range(count):
        cells += _entries(after[k]) * (len(echoes) if k < known else 1)
        _note(after[k], noted[k])
    keep = _kept(after[:count], noted[:count])
    return after[keep], noted[keep], cells


@njit(cache=True)
def _heard(
    beliefs: Floats,
    notes: Floats,
    cones: Cones,
    echoes: Floats,
    lateral_m: float,
    model: EchoModel,
) -> Floats:
    """Take in every forward echo for every thing; how well each echo is explained.

    What is known to stand or to come claims its echoes first, the nearest first: it hides the
    rest.
    """
    explained, walls = np.zeros(len(echoes)), np.zeros(len(echoes))
    claims = np.empty(len(notes))
    for k in range(len(notes)):
        _note(beliefs[k], notes[k])
        claims[k] = np.inf
        if beliefs[k, WEIGHT, 0].sum() > SETTLED:
            claims[k] = notes[k, STANDS_AT_M]
        elif notes[k, APPROACHING] > SETTLED:
            claims[k] = _walks_at_m(beliefs[k])
    for k in np.argsort(claims, kind="mergesort"):
        shares = _listen_all(beliefs[k], notes[k], cones, echoes, walls, lateral_m, model)
        for cone in range(len(echoes)):
            explained[cone] = max(explained[cone], shares[cone])
            if claims[k] < np.inf:
                walls[cone] = max(walls[cone], shares[cone])
    return explained


@njit(cache=True)
def _listen_all(
    belief: Floats,
    note: Floats,
    cones: Cones,
    echoes: Floats,
    walls: Floats,
    lateral_m: float,
    model: EchoModel,
) -> Floats:
    """One thing after the forward echoes; ``walls`` says which are of a thing before it."""
    shares = np.zeros(len(echoes))
    false = note[FALSE]
    for cone in range(len(echoes)):
        echo_m, sigma_m = echoes[cone, 0], echoes[cone, 1]
        if walls[cone] > 0.5:
            false = hide(belief, false, cones, cone, echo_m, sigma_m, lateral_m, model)
        else:
            false, share = listen(belief, false, cones, cone, echo_m, sigma_m, lateral_m, model)
            shares[cone] = share
    note[FALSE] = false
    if shares.max() > 0.5:
        note[PINGS] += 1
    return shares


@njit(cache=True)
def _add_new(
    beliefs: Floats,
    notes: Floats,
    known: int,
    cones: Cones,
    echoes: Floats,
    explained: Floats,
    time_s: float,
    lateral_m: float,
    model: EchoModel,
) -> int:
    """A thing for each group of echoes that nothing known explains, the nearest echo first."""
    free = np.zeros(len(echoes), dtype=np.bool_)
    for cone in range(len(echoes)):
        free[cone] = explained[cone] < 0.5 and not math.isnan(echoes[cone, 0])
    count = known
    for first in np.argsort(echoes[:, 0], kind="mergesort"):
        if not free[first]:
            continue
        nearest_m, sigma_m = echoes[first, 0], echoes[first, 1]
        false = bear(beliefs[count], cones, first, nearest_m, sigma_m, lateral_m, model)
        for cone in range(len(echoes)):
            other_m, sigma_m = echoes[cone, 0], echoes[cone, 1]
            if cone != first and explained[cone] < 0.5:
                false, _ = listen(
                    beliefs[count], false, cones, cone, other_m, sigma_m, lateral_m, model
                )
            if other_m - nearest_m <= SAME_M:
                free[cone] = False
        notes[count, FALSE], notes[count, PINGS], notes[count, FIRST_S] = false, 1.0, time_s
        count += 1
    return count


@njit(cache=True)
def _note(belief: Floats, note: Floats) -> None:
    """Write down what others ask of a belief."""
    standing = belief[WEIGHT, 0].sum()
    note[APPROACHING] = belief[WEIGHT, 1:].sum()
    note[STANDS_AT_M] = np.inf
    if standing > 0.0:
        note[STANDS_AT_M] = (belief[WEIGHT, 0] * belief[DISTANCE, 0]).sum() / standing


@njit(cache=True)
def _entries(belief: Floats) -> int:
    """Table entries of a belief that may yet be true."""
    rows = 0
    for row in range(SHAPE[1]):
        if belief[WEIGHT, row].sum() > 0.0:
            rows += 1
    return rows * SHAPE[2]


@njit(cache=True)
def _kept(beliefs: Floats, notes: Floats) -> NDArray[np.int64]:
    """The things that are likely enough to be there, the likeliest few, none twice."""
    rank = notes[:, FALSE].copy()
    for k in range(len(rank)):
        for other in range(k):
            if notes[other, FALSE] < GONE and _same(beliefs, notes, k, other):
                rank[k] = 1.0
        if rank[k] >= GONE:
            rank[k] = np.inf
    best = np.argsort(rank, kind="mergesort")[:MOST_THINGS]
    kept: NDArray[np.int64] = np.sort(best[rank[best] < np.inf])
    return kept


@njit(cache=True)
def _same(beliefs: Floats, notes: Floats, a: int, b: int) -> bool:
    """Whether two things are one: both walk and are as far away, or both stand in one place.

    Two who walk abreast are taken for one: their echoes cannot be told apart.
    """
    if min(notes[a, APPROACHING], notes[b, APPROACHING]) >= WALKS:
        return abs(_walks_at_m(beliefs[a]) - _walks_at_m(beliefs[b])) <= SAME_M
    one, two = beliefs[a, WEIGHT, 0], beliefs[b, WEIGHT, 0]
    if min(one.sum(), two.sum()) < SETTLED:
        return False
    shared: float = np.minimum(one / one.sum(), two / two.sum()).sum()
    return shared > 0.5 and abs(notes[a, STANDS_AT_M] - notes[b, STANDS_AT_M]) <= SAME_M


@njit(cache=True)
def _walks_at_m(belief: Floats) -> float:
    """Expected distance of a thing if it walks."""
    weight = belief[WEIGHT, 1:]
    expected: float = (weight * belief[DISTANCE, 1:]).sum() / weight.sum()
    return expected
