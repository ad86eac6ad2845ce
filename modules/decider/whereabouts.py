"""Which way, where the robot may be in several places: at once, or after a look somewhere.

Section 2: "you will have to choose whether or not it is worth your while to look for the
restaurant". To act is to go to the goal as if at one registration, and where that turns out wrong
as if at the others, the likeliest first. To look is to drive somewhere that a registration knows a
way to, and to act from there by the type of the junction that is found. What each takes is driven
in maps drawn from the belief of each registration, so a wrong answer costs what it takes to find it
out and to put it right (:mod:`modules.decider.as_if_kernels`). :func:`decide_detour` chooses.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from bus.grid import DIRECTIONS, JUNCTION_TYPES
from modules.decider.cases import Cases, Looked
from modules.decider.familiar import Detour, Familiar, decide_detour
from modules.decider.frames import Route, routes_to_look
from modules.decider.hypotheses import Hypotheses, by_junction_type
from modules.decider.options import levels_at, some_step
from modules.decider.roads import roads_of
from modules.decider.route_kernels import way_to_goal
from modules.decider.situation import Decision, Situation, SituationError

Floats = NDArray[np.float64]

LOOKS = 12
"""Places to look at that are considered, the nearest ones."""

MAPS = (1, 2, 4, 8, 16)
"""The sizes of problem to choose from: maps for each registration and junction type ahead."""

TELLS = 0.02
"""A look that is expected to make the likeliest registration more probable by less is none: by so
few maps that may be chance."""

Rule: TypeAlias = Literal["least expected cost", "act", "look"]


@dataclass(frozen=True, eq=False)
class Whereabouts:
    """What the decision rests on: a situation for each registration, all with the same goal ahead.

    ``weights`` (registrations,) are their probabilities, ``ahead`` (registrations, 16) what each
    says of the type of the junction ahead. ``left_s`` is the time from arrival there until the
    errand is late, ``late_price`` what each late second costs more. Raises SituationError for what
    does not fit together.
    """

    situations: tuple[Situation, ...]
    weights: Floats
    ahead: Floats
    left_s: float = np.inf
    late_price: float = 0.0

    def __post_init__(self) -> None:
        n, goals = len(self.situations), [s.goals[:1] for s in self.situations]
        if not n or (n > 1 and (not goals[0] or len(dict.fromkeys(goals)) > 1)):
            raise SituationError(f"goals ahead: found {goals}, expected one, the same for all")
        for name, found, shape in (
            ("weights", self.weights, (n,)),
            ("ahead", self.ahead, (n, JUNCTION_TYPES)),
        ):
            if found.shape != shape:
                raise SituationError(f"{name} has shape {found.shape}, expected {shape}")


@dataclass(frozen=True, eq=False)
class Choice:
    """The decision, and why: for each junction type as in bus.messages.RegistrationDecision."""

    decision: Decision
    acts_at: NDArray[np.int64]
    looks_at: NDArray[np.int64]


def decide_whereabouts(
    asked: Whereabouts, maps_per_type: int, rule: Rule = "least expected cost"
) -> Choice:
    """Act or look, for each junction type ahead, whichever takes less on average.

    ``known_s`` of the decision is what acting at once costs, ``unknown_s`` what looking first
    costs, infinite where there is nothing to look at; ``explores`` whether it looks. The other
    rules are for comparison: never to look, or to look wherever that tells most as long as it
    tells anything. A type of which no map has one gets a step that may lead to the goal of the
    likeliest registration.
    """
    limited = [
        by_junction_type(s, roads_of(s.grid, s.corridor_s), maps_per_type) for s in asked.situations
    ]
    branches = [
        _branch(asked, t, [found.get(t) for found in limited], rule) for t in range(JUNCTION_TYPES)
    ]
    decision = Decision(
        np.array([b.direction for b in branches], np.uint8),
        np.array([b.now_s for b in branches]),
        np.array([b.look_s for b in branches]),
        np.array([b.looks for b in branches]),
        sum(b.cells for b in branches),
        sum(len(h.maps) for found in limited for h in found.values()),
    )
    acts_at = np.array([b.acts_at for b in branches], np.int64)
    return Choice(decision, acts_at, np.array([b.looks_at for b in branches], np.int64))


def whereabouts_cells(registrations: int, types: int, maps_per_type: int) -> int:
    """The most cells that :func:`decide_whereabouts` can take: a drive through a map is one.

    Every order of registrations is driven in every map, at once and after every look.
    """
    return types * maps_per_type * registrations**3 * (1 + LOOKS)


def most_maps(registrations: int, types: int, cells: int) -> int:
    """The most maps, of :data:`MAPS`, that so many cells allow; the fewest where none fits."""
    fits = [n for n in MAPS if whereabouts_cells(registrations, types, n) <= cells]
    return max(fits, default=MAPS[0])


@dataclass(frozen=True)
class _Branch:
    """The decision for one junction type."""

    direction: int
    now_s: float = np.inf
    look_s: float = np.inf
    looks: bool = False
    acts_at: int = -1
    looks_at: int = -1
    cells: int = 0


def _branch(
    asked: Whereabouts, junction_type: int, maps: Sequence[Hypotheses | None], rule: Rule
) -> _Branch:
    chances = asked.weights * asked.ahead[:, junction_type]
    fit = [(r, h) for r, h in enumerate(maps) if h is not None and chances[r] > 0.0]
    if not fit:
        return _Branch(_step(asked.situations[int(asked.weights.argmax())], junction_type))
    situations = [asked.situations[r] for r, _ in fit]
    weights = chances[[r for r, _ in fit]]
    cases = Cases(situations, weights / weights.sum(), [h for _, h in fit], junction_type)
    act_s, drives = cases.act_s()
    nothing = np.ones((1, act_s.shape[1]))
    now = decide_detour(_familiar(asked, cases, act_s, Looked(act_s, nothing, 0)))
    looks, more = _looks(asked, cases, act_s) if rule != "act" else ([], 0)
    cells = drives + more
    best = min(looks, key=partial(_worse, rule), default=None)
    if best is not None and (rule == "look" or best.detour.pays):
        route = best.route
        step, at = DIRECTIONS[int(route.steps[0])], situations[route.frame].place
        return _Branch(step, now.now_s, best.detour.look_s, True, at, route.to, cells)
    look_s = np.inf if best is None else best.detour.look_s
    acts = situations[int(cases.orders[now.act, 0])]
    step = _step(acts, junction_type)
    return _Branch(step, now.now_s, look_s, False, acts.place, -1, cells)


@dataclass(frozen=True, eq=False)
class _Look:
    route: Route
    detour: Detour
    tells: float
    """How much more probable the likeliest registration is expected to become."""


def _looks(asked: Whereabouts, cases: Cases, act_s: Floats) -> tuple[list[_Look], int]:
    """The looks that tell registrations apart, and the drives it took to find them."""
    if len(cases.weights) == 1:
        return [], 0
    found, drives = [], 0
    for route in routes_to_look(cases.situations, cases.frames, LOOKS):
        looked = cases.looked(route.steps)
        if looked is None:
            continue
        drives += looked.drives
        tells = _tells(cases, looked)
        if tells > TELLS:
            question = _familiar(asked, cases, act_s, looked)
            found.append(_Look(route, decide_detour(question), tells))
    return found, drives


def _worse(rule: Rule, look: _Look) -> tuple[float, float]:
    """By cost; whoever always looks goes where that tells most."""
    return (-round(look.tells, 6) if rule == "look" else 0.0, look.detour.look_s)


def _tells(cases: Cases, looked: Looked) -> float:
    """By how much a look is expected to raise the probability of the likeliest registration."""
    first = np.unique(cases.of, return_index=True)[1]
    joint = looked.shows[:, first] * cases.weights
    return float(joint.max(axis=1).sum() - cases.weights.max())


def _familiar(asked: Whereabouts, cases: Cases, act_s: Floats, looked: Looked) -> Familiar:
    return Familiar(
        cases.probability, act_s, looked.after_s, looked.shows, asked.left_s, asked.late_price
    )


def _step(situation: Situation, junction_type: int) -> int:
    """Direction bit of the surest way to the goal, as this registration has it."""
    roads = roads_of(situation.grid, situation.corridor_s)
    levels = levels_at(situation, junction_type)
    settled = np.zeros(situation.grid.intersections, np.bool_)
    way, _, level = way_to_goal(roads, levels, situation.place, situation.goals[0], settled)
    return DIRECTIONS[way[0]] if level else some_step(situation, junction_type)
