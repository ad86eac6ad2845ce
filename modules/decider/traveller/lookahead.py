"""Where to go next, by looking ahead over worlds."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from modules.decider.roads import Roads
from modules.decider.traveller.errand_kernels import Errands, mean_cost
from modules.decider.traveller.tree import Problem, room, scratch_for
from modules.decider.traveller.tree_kernels import plan_tree
from modules.decider.traveller.way_kernels import FREE, UNKNOWN
from modules.decider.traveller.world_kernels import clairvoyant

CAUTIONS = ((0.0, 0.0), (0.0, 0.25), (0.0, 0.5), (0.0, 1.0), (0.0, 2.0), (0.5, 0.0), (1.0, 0.0))
"""The base policies: what an edge that is free with probability p costs more than its length, in
mean edges: (1 - p)(a + b/p), for each (a, b). The first is the optimist."""


class PlanError(ValueError):
    """A question that makes no sense: what was found, what was expected."""


@dataclass(frozen=True)
class Moves:
    """Every move worth considering: a way over free edges to the goal or to news."""

    to: NDArray[np.int64]
    """(k,): the vertex where each ends."""
    cost: NDArray[np.float64]
    """(k,): of the way there."""
    expected: NDArray[np.float64]
    """(k,): cost to the goal if it begins so and the plan found is followed, mean over worlds."""
    bound: NDArray[np.float64]
    """(k,): at most this, whatever the plan."""
    cells: int
    """Drives of a base policy through a world."""

    @property
    def best(self) -> int:
        """Index of the move of least expected cost; the first of equals."""
        return int(np.argmin(self.expected))


def look_ahead(
    roads: Roads,
    known: NDArray[np.uint8],
    place: int,
    goal: int,
    worlds: NDArray[np.uint8],
    cells: int,
) -> Moves:
    """:func:`look_ahead_over` with one goal and equally likely worlds."""
    errands = Errands(np.array([goal], np.int64), np.ones(1), 0.0)
    return look_ahead_over(roads, known, place, errands, worlds, np.ones(len(worlds)), cells)


def look_ahead_over(
    roads: Roads,
    known: NDArray[np.uint8],
    place: int,
    errands: Errands,
    worlds: NDArray[np.uint8],
    odds: NDArray[np.float64],
    cells: int,
) -> Moves:
    """The expected cost of each next move from ``place``, where edges are learnt by arriving.

    ``known`` (edges,) holds BLOCKED, UNKNOWN or FREE, known at every edge of ``place``.
    ``worlds`` (n, edges) are samples of what may be, 1 for free, each with a way to all goals of
    ``errands``, and ``odds`` (n,) their weights; they may come from any joint distribution. What
    is learnt on the way to one goal serves all later ones. The policy that is cheapest over
    them, of :data:`CAUTIONS`, becomes the base policy; then a tree of moves grows where it can
    save most, down to leaves from where the base policy is driven. At most ``cells`` such drives
    are made, known before the start (:func:`least_cells` are needed). Nothing is drawn: the same
    question has the same answer, bit for bit.

    Raises :class:`PlanError` for no worlds, worlds that contradict ``known`` or have no way, an
    unknown edge at ``place``, no goal elsewhere, or too few cells.
    """
    _check(roads, known, place, worlds, cells)
    if not (errands.goals != place).any():
        raise PlanError(f"goals {errands.goals.tolist()}, expected one that is not {place}")
    bounds = _clairvoyant(roads, worlds, errands)
    if not np.isfinite(bounds[:, 0, place]).all():
        world = int(np.flatnonzero(~np.isfinite(bounds[:, 0, place]))[0])
        goals = ", ".join(str(goal) for goal in errands.goals)
        raise PlanError(f"world {world} has no way from {place} to {goals}, expected one in each")
    hopes = _hopes(roads, worlds, odds)
    driven = [mean_cost(roads, errands, worlds, odds, known, hope, place) for hope in hopes]
    base = hopes[int(np.argmin(driven))]
    problem = Problem(roads, errands, worlds, odds, bounds, base)
    tried = len(hopes) * len(worlds)
    tree = room(cells - tried, len(known), len(roads.corridor))
    plan_tree(problem, tree, scratch_for(len(roads.corridor), len(known)), known, place)
    nodes, actions = tree.nodes, tree.actions
    if not nodes.actions[0]:
        raise PlanError(f"no room for one move in {cells} cells with {len(worlds)} worlds")
    k = slice(0, int(nodes.actions[0]))  # the root is looked into first
    return Moves(
        actions.to[k].copy(),
        actions.cost[k].copy(),
        actions.upper[k].copy(),
        actions.lower[k].copy(),
        tried + int(tree.used[2]),
    )


def _clairvoyant(roads: Roads, worlds: NDArray[np.uint8], errands: Errands) -> NDArray[np.float64]:
    """Cost from every vertex of the goals from each on, if the world were known: (n, k, v)."""
    fields = {
        goal: clairvoyant(roads, worlds, goal) for goal in dict.fromkeys(errands.goals.tolist())
    }
    costs = np.empty((len(worlds), len(errands.goals), len(roads.corridor)))
    rest = np.zeros(len(worlds))
    for stage in range(len(errands.goals) - 1, -1, -1):
        goal = int(errands.goals[stage])
        costs[:, stage] = errands.weight[stage] * fields[goal] + rest[:, np.newaxis]
        rest = costs[:, stage, int(errands.goals[stage - 1])]
    return costs


def least_cells(vertices: int, worlds: int) -> int:
    """Cells that always suffice to compare all moves: every base policy, the root, its moves."""
    return worlds * (len(CAUTIONS) + vertices)


def _hopes(
    roads: Roads, worlds: NDArray[np.uint8], odds: NDArray[np.float64]
) -> list[NDArray[np.float64]]:
    """For each base policy, what it takes unknown edges to cost, (edges,)."""
    p = np.maximum(np.average(worlds, axis=0, weights=odds), 0.5 / len(worlds))
    mean = float(np.mean(roads.seconds))
    return [roads.seconds + mean * (1.0 - p) * (over + odds / p) for over, odds in CAUTIONS]


def _check(
    roads: Roads,
    known: NDArray[np.uint8],
    place: int,
    worlds: NDArray[np.uint8],
    cells: int,
) -> None:
    edges, vertices = len(roads.seconds), len(roads.corridor)
    if worlds.ndim != 2 or worlds.shape[1] != edges or not len(worlds):
        raise PlanError(f"worlds have shape {worlds.shape}, expected (1 or more, {edges})")
    if known.shape != (edges,):
        raise PlanError(f"known has shape {known.shape}, expected ({edges},)")
    for edge in roads.corridor[place]:
        if edge >= 0 and known[edge] == UNKNOWN:
            raise PlanError(f"edge {edge} of {place} is unknown, expected where the traveller is")
    wrong = ((worlds > 0) != (known == FREE)) & (known != UNKNOWN)
    if wrong.any():
        world, edge = np.argwhere(wrong)[0].tolist()
        raise PlanError(f"world {world} contradicts what is known of edge {edge}")
    if cells < least_cells(vertices, len(worlds)):
        raise PlanError(
            f"{cells} cells, expected at least {least_cells(vertices, len(worlds))} "
            f"for {len(worlds)} worlds and {vertices} vertices"
        )
