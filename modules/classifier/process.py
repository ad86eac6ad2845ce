"""The classifier's messages: priors and readings in, choices and likelihoods out.

The belief about the junction is the geographer's prior times this visit's likelihood; the
likelihood alone goes back, so nothing is counted twice. What a wrong type costs is the decider's to
say; where that comes after the first answer of a visit, and in time, the answer is given again.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import msgspec
import numpy as np
from numpy.typing import NDArray

from bus.facts import Facts
from bus.messages import (
    Arrival,
    AskedSensing,
    Departure,
    JunctionLikelihood,
    JunctionPrior,
    JunctionStakes,
    SensingDecision,
)
from bus.messages import Reading as Read
from bus.turns import Handler, Turn
from bus.wire import MessageId
from modules.classifier.choose import (
    STOP,
    cells_before,
    choose,
    flat_cost_s,
    look_ahead_within,
    rehearse,
)
from modules.classifier.likelihood import STATES, Reading, junction_likelihood
from modules.classifier.sensor_model import SHIPPED, SensorModel, load_sensor_model
from modules.classifier.settings import Settings
from modules.classifier.worth import LOOK_AHEAD

SPARE_NS = 1_000_000_000
"""A second answer is not begun where less than so much more time would be left: it must be with
everybody before the first one is acted on."""


class Classifier:
    """Keeps the readings of the present visit and what it has decided for each outcome."""

    def __init__(self, model: SensorModel, settings: Settings) -> None:
        self._model = model
        self._settings = settings
        self._flat_s = flat_cost_s(settings.wrong_type_s)
        self._stakes: JunctionStakes | None = None
        self._stakes_from: tuple[MessageId, ...] = ()
        self._answered: AskedSensing | None = None  # the first question of a visit, until arrival
        self._visit = -1
        self._heading = 0
        self._arrived = False
        self._prior: JunctionPrior | None = None
        self._readings: tuple[Reading, ...] = ()
        self._read_from: tuple[MessageId, ...] = ()  # the messages of these readings
        self._asked_by: tuple[MessageId, ...] = ()
        self._prior_from: tuple[MessageId, ...] = ()
        self._asked: AskedSensing | None = None
        self._branch: tuple[int, ...] = ()  # the next detector for each outcome
        self._running: int | None = None
        self.handlers: Mapping[str, Handler] = {
            "percept/departure": self._departed,
            "percept/arrival": self._came,
            "prior/junction": self._expect,
            "stakes/junction": self._weigh,
            "asked/sensing": self._ask,
            "reading/feature": self._read,
        }

    def _departed(self, said: Departure, turn: Turn) -> None:
        turn.work("note", 1)
        self._visit, self._heading = said.visit, said.heading
        self._arrived = False
        self._readings, self._branch, self._running = (), (), None
        self._read_from = ()
        self._answered = None

    def _came(self, _said: Arrival, turn: Turn) -> None:
        turn.work("note", 1)
        self._arrived = True
        self._answered = None
        self._finish_if_nothing_to_read(turn)

    def _expect(self, said: JunctionPrior, turn: Turn) -> None:
        turn.work("note", len(said.prior))
        self._prior = said
        self._prior_from = (turn.heard,)
        self._decide(turn)

    def _ask(self, said: AskedSensing, turn: Turn) -> None:
        turn.work("note", 1)
        self._asked = said
        self._asked_by = (turn.heard,)
        self._decide(turn)

    def _weigh(self, said: JunctionStakes, turn: Turn) -> None:
        """Hear what a wrong type would cost; what was decided without it is decided again.

        Not where the second answer might be late: the first one stands.
        """
        turn.work("note", len(said.regret_s))
        if not self._settings.heeds_stakes:
            return
        self._stakes, self._stakes_from = said, (turn.heard,)
        first = self._answered
        if first is None or first.visit != said.visit:
            return
        again = msgspec.structs.replace(first, until_ns=first.until_ns - SPARE_NS)
        cells = cells_before((), None, self._heading, self._model, LOOK_AHEAD[0])
        if turn.costs.cost_ns("sensing", cells) <= turn.left_ns(again.until_ns):
            self._asked, self._running = again, None
            self._decide(turn)

    def _decide(self, turn: Turn) -> None:
        """Choose for every outcome, once the question and the prior are both there."""
        asked, prior = self._asked, self._prior
        if asked is None or prior is None or prior.visit != asked.visit:
            return
        self._asked = None
        said = self._stakes is not None and self._stakes.visit == asked.visit
        choice = choose(
            prior.prior,
            self._readings,
            self._running,
            self._heading,
            self._model,
            self._cost_s(self._stakes if said else None),
            self._look_ahead(asked, turn),
        )
        turn.work("sensing", choice.cells)
        self._branch = tuple(choice.next_detector.tolist())
        turn.say(
            SensingDecision(
                asked.decision,
                asked.visit,
                asked.action,
                choice.next_detector,
                choice.concluded_type,
                choice.worth_s,
                choice.look_ahead,
            ),
            *self._asked_by,
            *self._prior_from,
            *(self._stakes_from if said else ()),
            *self._read_from,
        )
        self._answered = None if said or asked.action else asked
        self._begin_first(turn)

    def _cost_s(self, stakes: JunctionStakes | None) -> NDArray[np.float64]:
        """What each conclusion costs: what is said, times the doubt, up to its own price."""
        if stakes is None:
            return self._flat_s
        return np.minimum(self._flat_s, self._settings.doubt * stakes.regret_s)

    def _look_ahead(self, asked: AskedSensing, turn: Turn) -> int:
        """How far plans may look ahead in the time left (a fixed-time procedure; section 5)."""
        return look_ahead_within(
            turn.costs.cells_within("sensing", turn.left_ns(asked.until_ns)),
            self._settings.look_ahead,
            self._readings,
            self._running,
            self._heading,
            self._model,
        )

    def _begin_first(self, turn: Turn) -> None:
        """Before the first reading of a visit there is one outcome only."""
        if len(self._branch) == 1:
            self._running = None if self._branch[0] == STOP else self._branch[0]
            self._finish_if_nothing_to_read(turn)

    def _finish_if_nothing_to_read(self, turn: Turn) -> None:
        if self._arrived and self._branch == (STOP,) and not self._readings:
            self._branch = ()
            self._say_likelihood(turn, finished=True)

    def _read(self, said: Read, turn: Turn) -> None:
        reading = Reading(self._model.wedges.code(said.feature, said.wedge), said.evidence)
        self._readings = (*self._readings, reading)
        self._read_from = (*self._read_from, turn.heard)
        # The question about this action came when it began, so its answer is known by now.
        following = self._branch[said.evidence]
        self._running = following if following != STOP else None
        self._say_likelihood(turn, finished=following == STOP)
        self._branch = ()

    def _say_likelihood(self, turn: Turn, *, finished: bool) -> None:
        turn.work("reading", STATES * (1 + len(self._readings)))
        likelihood = junction_likelihood(self._readings, self._heading, self._model)
        turn.say(
            JunctionLikelihood(self._visit, likelihood, len(self._readings), finished),
            *self._read_from,
        )


def build(facts: Facts, settings: Settings, _seed: int) -> Classifier:
    """The classifier of one run.

    Raises SensorModelError if its model is not whole, or was made with another ring than the
    robot carries or another number of wedges. That echoes are noisier or fewer than in the trials
    the robot cannot know.
    """
    path = Path(settings.sensor_model) if settings.sensor_model is not None else SHIPPED
    ring = {key: float(value) for key, value in msgspec.structs.asdict(facts.ring).items()}
    model = load_sensor_model(path, ring, facts.wedges)
    rehearse(model)
    return Classifier(model, settings)
