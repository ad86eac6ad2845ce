"""Questions that whole runs asked of the three decision procedures, as they were asked."""

from __future__ import annotations

import importlib
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any
from unittest.mock import patch

import modules.classifier.process as classifier
import modules.decider.process as decider
import modules.reactor.process as reactor
from benchmarks.days import day, scenario_of
from modules.classifier.choose import Choice, Problem, choose, problem_of
from modules.decider import Decision, Situation, decide
from modules.reactor.react import Encounter, Reaction, encounter, react
from modules.reactor.sides import UNSEEN, Sides
from modules.reactor.tables import Diagram
from modules.reactor.track import Tracker

SCENARIOS = ("aces", "office-4x4")


@dataclass(frozen=True, eq=False)
class Meeting:
    """What a reaction is decided by."""

    met: tuple[Encounter, ...]
    doing: str
    diagram: Diagram
    sides: Sides


@dataclass
class Questions:
    """All that was asked, in the order in which it was."""

    path: list[Situation] = field(default_factory=list)
    sensing: list[Problem] = field(default_factory=list)
    reaction: list[Meeting] = field(default_factory=list)
    _things: list[Encounter] = field(default_factory=list)

    def decide(self, situation: Situation, hypotheses: int) -> Decision:
        """In place of the decider's: note the question, answer it as ever."""
        self.path.append(situation)
        return decide(situation, hypotheses)

    def choose(self, *asked: Any) -> Choice:
        """In place of the classifier's."""
        self.sensing.append(problem_of(*asked[:6]))
        return choose(*asked)

    def encounter(self, *asked: Any) -> Encounter:
        """In place of the reactor's belief about one thing."""
        self._things.append(encounter(*asked))
        return self._things[-1]

    def react(
        self, tracker: Tracker, doing: str, diagram: Diagram, sides: Sides = UNSEEN
    ) -> Reaction | None:
        """In place of the reactor's: the things that mattered are those looked at meanwhile."""
        self._things.clear()
        reaction = react(tracker, doing, diagram, sides)
        if self._things:
            self.reaction.append(Meeting(tuple(self._things), doing, diagram, sides))
        return reaction


@contextmanager
def noted() -> Iterator[Questions]:
    """Everything that is asked of the procedures within."""
    questions = Questions()
    reacting = importlib.import_module("modules.reactor.react")  # the name is also a function's
    with (
        patch.object(decider, "decide", questions.decide),
        patch.object(classifier, "choose", questions.choose),
        patch.object(reactor, "react", questions.react),
        patch.object(reacting, "encounter", questions.encounter),
    ):
        yield questions


def asked_in_runs(seeds: Sequence[int], scenarios: Sequence[str] = SCENARIOS) -> Questions:
    """The questions of whole runs, with 64 maps of each junction type to choose from."""
    with noted() as questions:
        for name in scenarios:
            for seed in seeds:
                day(
                    scenario_of(
                        name,
                        ["modules.geographer.maps_per_type=64", "modules.decider.model=paper"],
                        seed,
                    )
                )
    return questions


def spread(questions: Sequence[Any], most: int) -> list[Any]:
    """At most so many of them, evenly spread."""
    if len(questions) <= most:
        return list(questions)
    return [questions[k * len(questions) // most] for k in range(most)]
