"""What the robot knew, belief by belief: of the map, and of where it was on it."""

from __future__ import annotations

from dataclasses import dataclass, replace

from bus.messages import MapBelief
from logs.belief import FinalBelief, final_belief, fits
from logs.truth import Truth


@dataclass(frozen=True)
class Knowledge:
    """One belief about the map against the truth.

    ``x``, ``y`` is the junction ahead as the robot believed, ``true_x``, ``true_y`` the one at
    which it then stood; None where it never got there.
    """

    belief: FinalBelief
    x: int
    y: int
    true_x: int | None = None
    true_y: int | None = None

    @property
    def registered(self) -> bool | None:
        """Whether the robot was where it believed to be; None where that is not known."""
        if self.true_x is None:
            return None
        return (self.x, self.y) == (self.true_x, self.true_y)


@dataclass(frozen=True)
class Registration:
    """How often the robot was where it believed to be."""

    beliefs: int
    right: int
    wrong: int
    unknown: int


class Known:
    """Gathers the beliefs of one log."""

    def __init__(self, truth: Truth) -> None:
        self._truth = truth
        self._each: list[Knowledge] = []

    def believed(self, belief: MapBelief, at_s: float) -> bool:
        """Take in a belief; False if there is no building that it fits."""
        building = self._truth.building
        if building is None or not fits(belief, building):
            return False
        self._each.append(Knowledge(final_belief(belief, building, at_s), belief.x, belief.y))
        return True

    def each(self) -> tuple[Knowledge, ...]:
        """All beliefs in their order, with the places that were true."""
        return tuple(self._placed(known) for known in self._each)

    def _placed(self, known: Knowledge) -> Knowledge:
        place, grid = self._truth.place(known.belief.visit), self._truth.grid
        if place is None or grid is None:
            return known
        true_x, true_y = grid.place(place)
        return replace(known, true_x=true_x, true_y=true_y)


def registration(each: tuple[Knowledge, ...]) -> Registration:
    """How often the place believed in was the true one."""
    found = [known.registered for known in each]
    return Registration(len(found), found.count(True), found.count(False), found.count(None))
