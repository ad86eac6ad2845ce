"""Which evidence contradicts itself: a smallest part of it that no map fits.

QuickXplain (U. Junker, AAAI 2004): some k log2(n / k) questions for k culprits among n.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from bus.grid import Grid
from modules.geographer.errors import ContradictoryEvidenceError, Place
from modules.geographer.evidence import Evidence
from modules.geographer.pairs import Link
from modules.geographer.solution import Problem
from modules.geographer.solving import possible

Floats = NDArray[np.float64]
T = TypeVar("T")

KINDS = ("junction", "corridor", "pair")
"""What may contradict: by the number of an intersection, a corridor, a link."""


def smallest_conflict(items: Sequence[T], fits: Callable[[list[T]], bool]) -> list[T]:
    """A part of the items that does not fit, while it does without any one of them.

    `fits` must hold for no items, not for all, and not for more than what it does not hold for.
    """
    return _conflict([], False, list(items), fits)


def _conflict(
    kept: list[T], grew: bool, items: list[T], fits: Callable[[list[T]], bool]
) -> list[T]:
    """The part of the items that is needed for a conflict with those kept."""
    if grew and not fits(kept):
        return []
    if len(items) == 1:
        return items
    half = len(items) // 2
    second = _conflict(kept + items[:half], True, items[half:], fits)
    first = _conflict(kept + second, bool(second), items[:half], fits)
    return first + second


def contradiction(grid: Grid, problem: Problem, before: Evidence) -> ContradictoryEvidenceError:
    """The error for evidence that no map fits, given the prior `before`, which some map does."""
    evidence = problem.evidence
    items: list[tuple[str, int]] = [
        *(("junction", v) for v in _excluding(evidence.junctions, _fitting(grid))),
        *(("corridor", c) for c in _excluding(evidence.corridors, before.corridors > 0.0)),
        *(("pair", number) for number in range(len(evidence.links))),
    ]

    def fits(kept: list[tuple[str, int]]) -> bool:
        chosen = {kind: [n for of, n in kept if of == kind] for kind in KINDS}
        part = _support(evidence, before, chosen)
        return possible(replace(problem, evidence=part))

    found = smallest_conflict(items, fits)
    places = [n for kind, n in found if kind == "junction"]
    for kind, number in found:
        if kind == "pair":
            link = evidence.links[number]
            places += [int(problem.sweep.intersections[s]) for s in (link.start, link.end)]
    junctions = [grid.place(v) for v in sorted(dict.fromkeys(places))]
    ends = [grid.ends(n) for kind, n in found if kind == "corridor"]
    corridors = [(grid.place(a), grid.place(b)) for a, b in ends]
    return ContradictoryEvidenceError(_message(junctions, corridors), junctions, corridors)


def _message(junctions: list[Place], corridors: list[tuple[Place, Place]]) -> str:
    named = ", ".join(f"[{x},{y}]" for x, y in junctions)
    between = ", ".join(f"[{a},{b}]-[{c},{d}]" for (a, b), (c, d) in corridors)
    parts = [named and f"junctions [x,y] {named}", between and f"corridors {between}"]
    return (
        f"no connected map has positive probability: no map fits the evidence at "
        f"{' and '.join(part for part in parts if part)} together"
    )


def _excluding(factors: Floats, allowed: NDArray[np.bool_]) -> list[int]:
    """The rows that rule out something that was allowed."""
    return [int(i) for i in np.flatnonzero(((factors == 0.0) & allowed).any(axis=1))]


def _fitting(grid: Grid) -> NDArray[np.bool_]:
    return np.array([grid.possible_types(*grid.place(v)) for v in range(grid.intersections)])


def _support(evidence: Evidence, before: Evidence, chosen: dict[str, list[int]]) -> Evidence:
    """Factors 0 and 1: what the prior and the chosen evidence rule out."""
    junctions = np.ones_like(evidence.junctions)
    corridors = (before.corridors > 0.0).astype(float)
    for factors, given, rows in (
        (junctions, evidence.junctions, chosen["junction"]),
        (corridors, evidence.corridors, chosen["corridor"]),
    ):
        factors[rows] = given[rows] > 0.0
    counts = None if evidence.counts is None else (evidence.counts > 0.0).astype(float)
    links = tuple(_supported(evidence.links[n]) for n in chosen["pair"])
    return Evidence(junctions, corridors, 0.0, counts, links)


def _supported(link: Link) -> Link:
    return replace(
        link, scales=(link.scales > 0.0).astype(float), rows=(link.rows > 0.0).astype(float)
    )
