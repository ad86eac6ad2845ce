"""Going as if somewhere, looking first, deciding between them: plain Python, by enumeration.

Everything lies where it is as seen from the robot, so nothing is shifted from grid to grid: a
corridor is a pair of (x, y) relative to the junction ahead. Shares nothing with the decider but the
maps of each registration and the levels of what is known.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from bus.grid import DIRECTIONS, STEP
from modules.decider.hypotheses import by_junction_type
from modules.decider.options import levels_at
from modules.decider.roads import roads_of
from modules.decider.situation import Situation
from modules.decider.whereabouts import Whereabouts

Point = tuple[int, int]
Edge = tuple[Point, Point]
ABSENT, IMPROBABLE, OPEN, PLANNED = range(4)


def edge(a: Point, b: Point) -> Edge:
    return (a, b) if a < b else (b, a)


def beyond(at: Point, direction: int) -> Point:
    return at[0] + STEP[direction][0], at[1] + STEP[direction][1]


@dataclass(frozen=True)
class Seen:
    """A registration as seen from the junction ahead."""

    situation: Situation
    levels: dict[Edge, int]
    seconds: dict[Edge, float]
    goal: Point
    corner: Point
    """Where the grid begins; ``size`` how far it goes."""
    size: Point

    @classmethod
    def of(cls, s: Situation, junction_type: int) -> Seen:
        x0, y0 = s.grid.place(s.place)
        levels = levels_at(s, junction_type)
        edges = {}
        for corridor in range(s.grid.corridors):
            (ax, ay), (bx, by) = (s.grid.place(end) for end in s.grid.ends(corridor))
            edges[edge((ax - x0, ay - y0), (bx - x0, by - y0))] = corridor
        gx, gy = s.grid.place(s.goals[0])
        return cls(
            s,
            {e: int(levels[c]) for e, c in edges.items()},
            {e: float(s.corridor_s[c]) for e, c in edges.items()},
            (gx - x0, gy - y0),
            (-x0, -y0),
            (s.grid.columns, s.grid.rows),
        )

    def inside(self, at: Point) -> bool:
        return all(0 <= at[k] - self.corner[k] < self.size[k] for k in (0, 1))

    def edges_of(self, truth: Sequence[int]) -> frozenset[Edge]:
        """A map of this registration as the corridors that are there."""
        x0, y0 = self.situation.grid.place(self.situation.place)
        found = set()
        for corridor, there in enumerate(truth):
            if there:
                ends = (self.situation.grid.place(e) for e in self.situation.grid.ends(corridor))
                a, b = ((x - x0, y - y0) for x, y in ends)
                found.add(edge(a, b))
        return frozenset(found)

    def fields(
        self, known: dict[Edge, int], at: Point, goal: Point
    ) -> tuple[dict[Point, float], int]:
        """Seconds to the goal by the surest plan, and the plan's level; 0 for none."""
        for level in (PLANNED, OPEN, IMPROBABLE):
            field = {goal: 0.0}
            for _ in range(self.size[0] * self.size[1]):
                for (a, b), how in known.items():
                    if how >= level:
                        for p, q in ((a, b), (b, a)):
                            through = self.seconds[edge(a, b)] + field.get(q, float("inf"))
                            if through < field.get(p, float("inf")):
                                field[p] = through
            if field.get(at, float("inf")) < float("inf"):
                return field, level
        return {}, 0


def drive(
    a: Seen, r: Seen, truth: frozenset[Edge], at: Point, penalty_s: float
) -> tuple[Point, float, bool]:
    """As if at ``a``, where ``r`` is the case and ``truth`` its map."""
    known, spent = dict(a.levels), 0.0
    if not a.inside(at):
        return at, 0.0, False
    while at not in (a.goal, r.goal):
        contradicted = False
        for direction in DIRECTIONS:
            e = edge(at, beyond(at, direction))
            if e in known:
                sure = known[e] != OPEN
                contradicted |= sure and (known[e] == PLANNED) != (e in truth)
                known[e] = PLANNED if e in truth else ABSENT
        if contradicted and a is not r:
            break
        field, level = a.fields(known, at, a.goal)
        if level == 0:
            return at, spent + penalty_s * (a is r), a is r
        ways = [
            (a.seconds[edge(at, beyond(at, d))] + field[beyond(at, d)], k, d)
            for k, d in enumerate(DIRECTIONS)
            if known.get(edge(at, beyond(at, d)), 0) >= level and beyond(at, d) in field
        ]
        direction = min(ways)[2]
        spent += a.seconds[edge(at, beyond(at, direction))] + a.situation.sensing_s
        at = beyond(at, direction)
    return at, spent, at == r.goal


def walk(r: Seen, truth: frozenset[Edge], route: Sequence[int]) -> tuple[Point, float, int, bool]:
    """Along direction bits until one is missing."""
    at, spent, met = (0, 0), 0.0, False
    for k, direction in enumerate(route):
        e = edge(at, beyond(at, direction))
        if e not in truth:
            return at, spent, k, met
        spent, at = spent + r.seconds[e] + r.situation.sensing_s, beyond(at, direction)
        met |= at == r.goal
    return at, spent, len(route), met


@dataclass(frozen=True)
class Best:
    """Least expected cost of acting at once, and of looking first by each route."""

    now_s: float
    by_route: dict[tuple[int, ...], float]


def solve(
    asked: Whereabouts, junction_type: int, routes: Sequence[Sequence[int]], most: int
) -> Best:
    """Every order of registrations that begins anywhere, every look, every outcome, every map."""
    chances, seen, maps = [], [], []
    for k, s in enumerate(asked.situations):
        h = by_junction_type(s, roads_of(s.grid, s.corridor_s), most).get(junction_type)
        if h is not None and asked.ahead[k, junction_type] > 0:
            one = Seen.of(s, junction_type)
            chances.append(float(asked.weights[k] * asked.ahead[k, junction_type]))
            seen.append(one)
            maps.append(
                [
                    (one.edges_of(m), float(w))
                    for m, w in zip(h.maps.tolist(), h.weights, strict=True)
                ]
            )
    share = [c / sum(chances) for c in chances]
    rest = sorted(range(len(seen)), key=lambda k: -share[k])
    acts = [[a, *[b for b in rest if b != a]] for a in rest]

    def price(taken_s: float) -> float:
        return (
            taken_s + asked.late_price * max(0.0, taken_s - asked.left_s)
            if asked.late_price
            else taken_s
        )

    def by_act(
        act: Sequence[int], r: int, truth: frozenset[Edge], at: Point, spent: float
    ) -> float:
        for a in act:
            s = seen[a].situation
            at, more, met = drive(
                seen[a], seen[r], truth, at, roads_of(s.grid, s.corridor_s).penalty_s
            )
            spent += more
            if met:
                break
        return spent

    cases = [(r, truth, w) for r in range(len(seen)) for truth, w in maps[r]]
    now = min(
        sum(share[r] * w * price(by_act(act, r, truth, (0, 0), 0.0)) for r, truth, w in cases)
        for act in acts
    )
    found = {}
    for route in routes:
        ends = [walk(seen[r], truth, route) for r, truth, _ in cases]
        if any(end[3] for end in ends):
            continue
        shown = [outcome(end, truth) for end, (_, truth, _) in zip(ends, cases, strict=True)]
        says = {
            (o, r): sum(w for s, (q, _, w) in zip(shown, cases, strict=True) if q == r and s == o)
            for o, r in itertools.product(set(shown), range(len(seen)))
        }
        found[tuple(route)] = sum(
            min(
                sum(
                    share[r] * w * says[o, r] * price(by_act(act, r, truth, end[0], end[1]))
                    for end, (r, truth, w) in zip(ends, cases, strict=True)
                )
                for act in acts
            )
            for o in sorted(set(shown))
        )
    return Best(now, found)


def outcome(end: tuple[Point, float, int, bool], truth: frozenset[Edge]) -> tuple[int, int]:
    """How far it came, and the junction type there."""
    at, _, steps, _ = end
    return steps, sum(d for d in DIRECTIONS if edge(at, beyond(at, d)) in truth)


def routes_of(seen: Sequence[Seen]) -> Iterator[tuple[int, ...]]:
    """Every simple way over corridors that are known to exist, as some registration has it."""
    for one in seen:
        stack: list[tuple[tuple[int, ...], Point, tuple[Point, ...]]] = [((), (0, 0), ((0, 0),))]
        while stack:
            steps, at, been = stack.pop()
            if steps:
                yield steps
            for d in DIRECTIONS:
                to = beyond(at, d)
                if one.levels.get(edge(at, to), 0) == PLANNED and to not in been:
                    stack.append(((*steps, d), to, (*been, to)))
