"""All pairs of a registration and a map, by enumeration: what a lost robot's beliefs must be.

As tests/scenarios/joint.py, for a robot that may have begun in several places. Written from the
log, what the robot is told beforehand, and the paper's words.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bus.facts import Recall
from bus.grid import OPPOSITE, STEP, Grid, Maps
from bus.messages import (
    Arrival,
    AtErrand,
    Blocked,
    Departure,
    JunctionLikelihood,
    JunctionPrior,
    MapBelief,
    Reading,
    Registrations,
)
from bus.wire import Sent
from tests.scenarios.joint import Joint, Moment, bits_at

Floats = NDArray[np.float64]


@dataclass
class Place:
    """Where the robot is if it began at one place, and the weight of every map then."""

    joint: Joint
    place: int
    ahead: int
    gone: bool = False

    @property
    def mass(self) -> float:
        return 0.0 if self.gone else float(self.joint.weight.sum())

    def step(self, heading: int) -> None:
        x, y = self.joint.grid.place(self.place)
        dx, dy = STEP[heading]
        x, y = x + dx, y + dy
        if 0 <= x < self.joint.grid.columns and 0 <= y < self.joint.grid.rows:
            self.ahead = self.joint.grid.intersection(x, y)
        else:
            self.gone = True

    def behind(self, heading: int) -> int:
        return self.joint.grid.corridor(*self.joint.grid.place(self.ahead), OPPOSITE[heading])


@dataclass
class LostWalk:
    """Follows a log with every place where the robot may have begun."""

    places: list[Place]
    heading: int = 0
    prior: Floats | None = None
    after: Floats | None = None
    """P(J) where it stands after its readings, before it moves on."""
    most: int = 0
    """The most registrations that were told of at once."""

    @property
    def left(self) -> list[Place]:
        return [place for place in self.places if place.mass > 0.0]

    @property
    def total(self) -> float:
        return sum(place.mass for place in self.left)

    def mean(self, of: Sequence[Floats]) -> Floats:
        """The average over pairs of what each registration's maps sum up to."""
        found: Floats = np.sum(of, axis=0) / self.total
        return found

    def hear(self, sent: Sent) -> Iterator[Moment]:
        match sent.message:
            case Departure() as said:
                self._departs(said)
            case Arrival():
                for place in self.left:
                    place.place = place.ahead
                self.after = self._here()
            case Blocked() as said:
                self._blocked(said)
            case AtErrand() as said:
                for place in self.left:
                    place.gone = (place.place == said.waypoint) != said.here
            case Reading() as said:
                for place in self.left:
                    place.joint.reading(place.place, self.heading, said)
                self.after = self._here()
            case _:
                yield from self._believed(sent)

    def _believed(self, sent: Sent) -> Iterator[Moment]:
        match sent.message:
            case JunctionPrior() as said:
                self.prior = said.prior
                yield Moment(said.visit, said.prior, self._ahead())
            case JunctionLikelihood(finished=True) as said:
                # the errand's end is no evidence that the prior could have had
                if self.prior is not None and self.after is not None and not self._dropped():
                    product = self.prior * said.likelihood
                    yield Moment(said.visit, product / product.sum(), self.after)
            case Registrations() as said:
                yield from self._where(said)
            case MapBelief() as said:
                yield from self._map(said)

    def _departs(self, said: Departure) -> None:
        self.heading = said.heading
        for place in self.left:
            if said.visit > 0:
                place.step(said.heading)
            if not place.gone:
                place.joint.corridor(place.behind(said.heading), exists=True)

    def _blocked(self, said: Blocked) -> None:
        for place in self.left:
            grid = place.joint.grid
            corridor = grid.corridor(*grid.place(place.place), said.heading)
            if corridor >= 0:
                place.joint.corridor(corridor, exists=False)

    def _types(self, at: Sequence[int]) -> Floats:
        return self.mean(
            [
                tally(bits_at(p.joint.maps, p.joint.grid, v), p.joint.weight)
                for p, v in zip(self.left, at, strict=True)
            ]
        )

    def _dropped(self) -> bool:
        return any(place.gone for place in self.places)

    def _ahead(self) -> Floats:
        return self._types([place.ahead for place in self.left])

    def _here(self) -> Floats:
        return self._types([place.place for place in self.left])

    def _where(self, said: Registrations) -> Iterator[Moment]:
        self.most = max(self.most, len(said.places))
        by_place = {place.ahead: place for place in self.left}
        assert set(said.places.tolist()) <= set(by_place)
        for row, v in enumerate(said.places.tolist()):
            place = by_place[v]
            weight = np.array([place.mass / self.total])
            yield Moment(said.visit, said.weights[row : row + 1], weight)
            share = place.joint.weight / place.mass
            types = tally(bits_at(place.joint.maps, place.joint.grid, v), share)
            yield Moment(said.visit, said.ahead[row], types)
            yield Moment(said.visit, said.corridors[row], share @ place.joint.maps)
            mine = said.of == row
            listed = rows_of(place.joint.maps, said.maps[mine])
            yield Moment(said.visit, np.exp(said.log_probability[mine]), share[listed])

    def _map(self, said: MapBelief) -> Iterator[Moment]:
        joint = self.left[0].joint
        pairs = np.array([place.joint.weight for place in self.left]) / self.total
        posterior = pairs.sum(axis=0)
        junctions = [
            tally(bits_at(joint.maps, joint.grid, v), posterior)
            for v in range(joint.grid.intersections)
        ]
        yield Moment(said.visit, said.junctions.reshape(-1, 16), np.array(junctions))
        yield Moment(said.visit, said.corridors, posterior @ joint.maps)
        positive = pairs[pairs > 0]
        entropy = -(positive * np.log(positive)).sum()
        yield Moment(said.visit, np.array([said.entropy]), np.array([entropy]))
        listed = rows_of(joint.maps, said.maps)
        yield Moment(said.visit, np.exp(said.log_probability), posterior[listed])
        best = max(self.left, key=lambda place: place.mass)
        told = next(p for p in self.left if p.ahead == joint.grid.intersection(said.x, said.y))
        yield Moment(said.visit, np.array([told.mass]), np.array([best.mass]))


def tally(types: NDArray[np.int64], weight: Floats) -> Floats:
    """How much weight each junction type has, (16,)."""
    return np.bincount(types, weight, 16).astype(np.float64)


def rows_of(maps: Maps, listed: Maps) -> list[int]:
    row = {corridors.tobytes(): k for k, corridors in enumerate(maps)}
    return [row[corridors.tobytes()] for corridors in listed]


def lost_walk(
    grid: Grid, maps: Maps, sensor: Floats, astray: float, recall: Recall, said: Sequence[Sent]
) -> tuple[list[Moment], LostWalk]:
    """All beliefs of a run with what they should be."""
    recalled = np.ones(len(maps))
    for one in recall.places:
        right = bits_at(maps, grid, one.place) == one.junction_type
        recalled = recalled * np.where(right, one.certain, (1.0 - one.certain) / 15)
    robot = LostWalk(
        [
            Place(
                Joint(grid, maps, sensor, astray, one.probability * recalled), one.place, one.place
            )
            for one in recall.may_be_at
        ]
    )
    return [moment for sent in said for moment in robot.hear(sent)], robot
