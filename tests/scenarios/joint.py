"""The one joint network of a whole run, by enumeration: what the processes must agree with.

Written from the paper's words and the log alone. A map's probability is its prior times, for
every visit, that of its readings, times 1 or 0 for every corridor that was driven or found to be a
wall. That of a visit's readings is the product of P(S|X) of the detectors where X is what the map's
junction would show there, summed over the doorways that it may have; or, if the visit has gone
astray, the product of what each detector says at any junction. Nothing of the geographer's, and of
the classifier's only the table P(S|X) and how often a visit goes astray, is used.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from itertools import product
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from bus.grid import EAST, LEFT_OF, NORTH, OPPOSITE, RIGHT_OF, SOUTH, STEP, WEST, Grid, Maps
from bus.messages import (
    Arrival,
    Blocked,
    Departure,
    JunctionLikelihood,
    JunctionPrior,
    MapBelief,
    Reading,
    TrueBuilding,
)
from bus.wire import Sent

Doors: TypeAlias = tuple[bool, bool, bool]
"""Whether the ways ahead, to the left and to the right begin with a doorway."""

Floats = NDArray[np.float64]
OPENING, FLAT_WALL, CONVEX_CORNER, CONCAVE_CORNER, DOOR_JAMB = range(5)
DOORS = 0.2
DOORWAYS = 0.1


NO_DOORS: Doors = (False, False, False)
EVERY_DOORS: tuple[Doors, ...] = tuple(
    (ahead, left, right) for ahead, left, right in product((False, True), repeat=3)
)


def shows(feature: int, wedge: int, junction: int, heading: int, doors: Doors = NO_DOORS) -> float:
    """Pr(X|J, doorways): whether a junction shows a feature in a wedge (paper, Fig. 3).

    Wedge 0 is ahead, then counter-clockwise every 45 degrees: 1 and 7 look at the middle of
    the sides (corners: at the far ones), 2 and 6 at the near corners, 3 to 5 at the corridor
    the robot stands in. In a wall to the side there may be a door. A corridor that begins with a
    doorway is open in its middle, and its corners are as if the wall ran on.
    """
    left = wedge < 4
    ahead = bool(junction & heading)
    side = bool(junction & (LEFT_OF if left else RIGHT_OF)[heading])
    ahead_ends, side_ends = ahead and not doors[0], side and not doors[1 if left else 2]
    if wedge in (1, 2, 6, 7) and feature in (CONVEX_CORNER, CONCAVE_CORNER):
        return _corner(feature, wedge, side_ends, ahead_ends)
    if feature == OPENING:
        return {0: ahead, 1: side, 7: side, 4: True}.get(wedge, False)
    if feature == FLAT_WALL:
        return {0: not ahead, 2: not side_ends, 6: not side_ends, 3: True, 4: False, 5: True}.get(
            wedge, not side
        )
    if feature == DOOR_JAMB:
        return DOORS * {1: not side, 7: not side, 3: True, 5: True}.get(wedge, False)
    return False


def _corner(feature: int, wedge: int, side: bool, ahead: bool) -> bool:
    """Whether there is a corner, by which of its walls end there as a corridor's."""
    near = wedge in (2, 6)
    if feature == CONCAVE_CORNER:
        return not near and not side and not ahead
    return side if near else side and ahead


def chance_of(doors: Doors, junction: int, heading: int) -> float:
    """Pr(doorways|J): each way ahead and to the sides has one with probability DOORWAYS."""
    chance = 1.0
    for direction, door in zip((heading, LEFT_OF[heading], RIGHT_OF[heading]), doors, strict=True):
        if junction & direction:
            chance *= DOORWAYS if door else 1.0 - DOORWAYS
        elif door:
            return 0.0
    return chance


def bits_at(maps: Maps, grid: Grid, place: int) -> NDArray[np.int64]:
    """The junction type of a place in every map."""
    found = np.zeros(len(maps), dtype=np.int64)
    for direction in (NORTH, EAST, SOUTH, WEST):
        corridor = grid.corridor(*grid.place(place), direction)
        if corridor >= 0:
            found |= direction * maps[:, corridor].astype(np.int64)
    return found


@dataclass
class Joint:
    """The unnormalised posterior of every map, as the evidence comes in."""

    grid: Grid
    maps: Maps
    sensor: Floats
    """P(S|X): (features, wedges, X, classes)."""
    astray: float
    weight: Floats
    before: Floats = field(init=False)
    """The weights before this visit's readings."""
    readings: list[Reading] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.before = self.weight

    def corridor(self, corridor: int, exists: bool) -> None:
        """A corridor was driven, or a wall was found in its place: a visit is over."""
        self.before = self.weight = self.weight * (self.maps[:, corridor] == exists)
        self.readings = []

    def reading(self, place: int, heading: int, said: Reading) -> None:
        """A detector found something at a place entered by a heading."""
        self.readings.append(said)
        of_type = np.array([self._of_visit(j, heading) for j in range(16)])
        self.weight = self.before * of_type[bits_at(self.maps, self.grid, place)]

    def _of_visit(self, junction: int, heading: int) -> float:
        """P(the readings of this visit|J)."""
        here = 0.0
        for doors in EVERY_DOORS:
            chance = chance_of(doors, junction, heading)
            if chance:
                said = [self._of_reading(said, junction, heading, doors) for said in self.readings]
                here += chance * float(np.prod(said))
        entered = [j for j in range(16) if j & OPPOSITE[heading]]
        elsewhere = 1.0
        for said_once in self.readings:
            elsewhere *= float(
                np.mean(
                    [
                        sum(
                            chance_of(doors, j, heading)
                            * self._of_reading(said_once, j, heading, doors)
                            for doors in EVERY_DOORS
                        )
                        for j in entered
                    ]
                )
            )
        return (1.0 - self.astray) * here + self.astray * elsewhere

    def _of_reading(self, said: Reading, junction: int, heading: int, doors: Doors) -> float:
        absent, there = self.sensor[said.feature, said.wedge, :, said.evidence].tolist()
        holds = shows(said.feature, said.wedge, junction, heading, doors)
        return float((1.0 - holds) * absent + holds * there)

    @property
    def posterior(self) -> Floats:
        """The probability of every map."""
        posterior: Floats = self.weight / self.weight.sum()
        return posterior

    def junction(self, place: int) -> Floats:
        """The marginal of a place's junction type, (16,)."""
        types = bits_at(self.maps, self.grid, place)
        marginal: Floats = np.bincount(types, self.posterior, 16).astype(np.float64)
        return marginal


@dataclass(frozen=True, eq=False)
class Moment:
    """One belief of the processes and the joint posterior of the same evidence."""

    visit: int
    said: Floats
    expected: Floats


@dataclass
class Walk:
    """Follows a log: where the robot is by its own lights, and what the joint network says."""

    joint: Joint
    start: int
    place: int = 0
    ahead: int = 0
    heading: int = 0
    visit: int = 0
    priors: dict[int, JunctionPrior] = field(default_factory=dict)
    after: dict[int, Floats] = field(default_factory=dict)
    """P(J) of each visit's junction after its readings, before the robot moves on."""
    errors: int = 0
    """Readings that contradict what ``truth`` would show."""
    truth: NDArray[np.uint8] | None = None

    def hear(self, sent: Sent) -> Iterator[Moment]:
        """Take a message in; what beliefs it states, with what they should be."""
        match sent.message:
            case Departure() as said:
                self._departs(said)
            case Arrival() as said:
                self.place = self.ahead
                self.after[said.visit] = self.joint.junction(self.place)
            case Blocked() as said:
                self.visit = said.visit
                self.joint.corridor(self._corridor(said.heading), exists=False)
            case Reading() as said:
                self._count_if_wrong(said)
                self.joint.reading(self.place, self.heading, said)
                self.after[said.visit] = self.joint.junction(self.place)
            case JunctionPrior() as said:
                self.priors[said.visit] = said
                yield Moment(said.visit, said.prior, self.joint.junction(self._told(said)))
            case JunctionLikelihood(finished=True) as said:
                product = self.priors[said.visit].prior * said.likelihood
                yield Moment(said.visit, product / product.sum(), self.after[said.visit])
            case MapBelief() as said:
                yield from self._of_the_map(said)

    def _departs(self, said: Departure) -> None:
        """The corridor ahead will have been driven by the time the belief is used."""
        self.visit, self.heading = said.visit, said.heading
        if said.visit == 0:
            self.ahead = self.start
            behind = self.joint.grid.corridor(
                *self.joint.grid.place(self.start), OPPOSITE[said.heading]
            )
        else:
            behind = self._corridor(said.heading)
            x, y = self.joint.grid.place(self.place)
            dx, dy = STEP[said.heading]
            self.ahead = self.joint.grid.intersection(x + dx, y + dy)
        self.joint.corridor(behind, exists=True)

    def _corridor(self, direction: int) -> int:
        return self.joint.grid.corridor(*self.joint.grid.place(self.place), direction)

    def _told(self, said: JunctionPrior) -> int:
        assert said.visit == self.visit
        assert self.joint.grid.intersection(said.x, said.y) == self.ahead
        return self.ahead

    def _of_the_map(self, said: MapBelief) -> Iterator[Moment]:
        joint = self.joint
        posterior = joint.posterior
        junctions = np.array([joint.junction(v) for v in range(joint.grid.intersections)])
        yield Moment(said.visit, said.junctions.reshape(-1, 16), junctions)
        yield Moment(said.visit, said.corridors, posterior @ joint.maps)
        positive = posterior[posterior > 0]
        entropy = -(positive * np.log(positive)).sum()
        yield Moment(said.visit, np.array([said.entropy]), np.array([entropy]))
        row = {corridors.tobytes(): k for k, corridors in enumerate(joint.maps)}
        listed = [row[corridors.tobytes()] for corridors in said.maps]
        yield Moment(said.visit, np.exp(said.log_probability), posterior[listed])

    def _count_if_wrong(self, said: Reading) -> None:
        assert self.truth is not None
        junction = int(bits_at(self.truth[None], self.joint.grid, self.place)[0])
        # there are neither doors nor doorways here
        holds = shows(said.feature, said.wedge, junction, self.heading) == 1.0
        self.errors += holds != (said.evidence >= 2)


def walk(
    said: Sequence[Sent], maps: Maps, sensor: Floats, astray: float, odds: float
) -> tuple[list[Moment], int]:
    """All beliefs of a run with what they should be, and how many readings were wrong."""
    building = next(s.message for s in said if isinstance(s.message, TrueBuilding))
    grid = Grid(len(building.columns_m), len(building.rows_m))
    joint = Joint(grid, maps, sensor, astray, odds ** maps.sum(axis=1, dtype=np.float64))
    robot = Walk(joint, start=building.start, truth=building.corridors)
    moments = [moment for sent in said for moment in robot.hear(sent)]
    return moments, robot.errors
