"""The method that a robot uses: one for all errands, or the best by estimate for each."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal, TypeAlias

import numpy as np

from bus.grid import JUNCTION_TYPES
from modules.decider.methods.contingent import decide_by_method, hypotheses_at
from modules.decider.methods.estimate import Estimates, choose_method, shipped_estimates
from modules.decider.methods.features import Outlook
from modules.decider.methods.ways import Method
from modules.decider.options import levels_at
from modules.decider.roads import roads_of
from modules.decider.situation import Decision, Situation

Choice: TypeAlias = Method | Literal["by estimate"]


@dataclass
class MethodInUse:
    """Decides by one method, or by the one of least estimated time for each new goal.

    A method is kept until its goal is reached: one changed half-way could undo what the other
    did. What ``random`` draws repeats with the generator.
    """

    choice: Choice
    rng: np.random.Generator
    estimates: Estimates = field(default_factory=shipped_estimates)
    method: Method = "section 4"
    """The method of the current goal."""
    _goal: int = -1

    def decide(self, situation: Situation) -> Decision:
        """The next corridor for each junction type at v."""
        if self.choice != "by estimate":
            self.method = self.choice
        elif situation.goals and situation.goals[0] != self._goal:
            self._goal = situation.goals[0]
            self.method = best_method(situation, self.estimates)
        return decide_by_method(situation, self.method, self.rng)


def best_method(situation: Situation, estimates: Estimates) -> Method:
    """The method of least estimated time to the current goal and for the expected later errands.

    Judged for the junction type that is the most probable at v; ties go to the lowest.
    """
    roads = roads_of(situation.grid, situation.corridor_s)
    types = situation.grid.junction_types(situation.maps)[:, situation.place]
    share = np.bincount(types, weights=situation.weights, minlength=JUNCTION_TYPES)
    likely = int(share.argmax())
    maps, probability = hypotheses_at(situation, roads, likely)
    outlook = Outlook(
        levels_at(situation, likely), maps, probability, situation.place, situation.goals[0]
    )
    later = float(sum(situation.expected.tolist()))
    return choose_method(estimates.of(roads, outlook), later).method
