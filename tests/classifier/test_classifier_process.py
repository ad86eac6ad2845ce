"""The classifier's process: whose price a wrong type has, and an answer that is given again."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from bus.costs import CostModel, Rate
from bus.facts import Facts
from bus.grid import NORTH, SOUTH, WEST
from bus.messages import (
    Arrival,
    AskedSensing,
    Departure,
    JunctionLikelihood,
    JunctionPrior,
    JunctionStakes,
    Message,
    Reading,
    SensingDecision,
)
from bus.turns import Turn
from modules.classifier.choose import STOP, cells_before, choose, flat_cost_s
from modules.classifier.process import SPARE_NS, Classifier, build
from modules.classifier.sensor_model import load_sensor_model
from modules.classifier.settings import Settings
from modules.classifier.worth import LOOK_AHEAD

MODEL = load_sensor_model()
FREE = CostModel("free")
PRIOR = np.zeros(16)
PRIOR[[SOUTH, SOUTH | WEST]] = 0.3, 0.7
NOTHING_AT_STAKE = np.zeros((16, 16))


def the_classifier(heeds_stakes: bool = True, doubt: float = 1.0) -> Classifier:
    settings = Settings(heeds_stakes=heeds_stakes, doubt=doubt)
    return build(Facts(3, 3, 0, NORTH, 0.085), settings, 1)


def hear(
    classifier: Classifier, topic: str, message: Message, costs: CostModel = FREE, at_ns: int = 0
) -> list[Message]:
    turn = Turn(at_ns, costs, ("somebody", 0))
    classifier.handlers[topic](message, turn)
    return [said for said, _ in turn.said]


def on_the_way(classifier: Classifier, until_ns: int = 240 * 10**9) -> SensingDecision:
    """Under way to visit 3, heading north, with its first answer."""
    hear(classifier, "percept/departure", Departure(3, NORTH))
    hear(classifier, "asked/sensing", AskedSensing(7, 3, 0, 0, until_ns))
    (answer,) = hear(classifier, "prior/junction", JunctionPrior(3, 1, 1, NORTH, PRIOR))
    assert isinstance(answer, SensingDecision)
    return answer


def stakes(regret_s: NDArray[np.float64], visit: int = 3) -> JunctionStakes:
    return JunctionStakes(visit, regret_s)


def test_alone_it_takes_its_own_price() -> None:
    answer = on_the_way(the_classifier())
    expected = choose(PRIOR, (), None, NORTH, MODEL, flat_cost_s(), LOOK_AHEAD[-1])
    assert answer.next_detector.tolist() == expected.next_detector.tolist()
    assert answer.next_detector[0] != STOP
    assert answer.worth_s.tobytes() == expected.worth_s.tobytes()


def test_what_is_said_before_arrival_is_decided_again() -> None:
    classifier = the_classifier()
    first = on_the_way(classifier)
    (again,) = hear(classifier, "stakes/junction", stakes(NOTHING_AT_STAKE))
    assert isinstance(again, SensingDecision)
    assert (again.decision, again.visit, again.action) == (first.decision, 3, 0)
    assert again.next_detector.tolist() == [STOP]
    # Nothing was read: on arrival it says all that it knows, and that it is through.
    (likelihood,) = hear(classifier, "percept/arrival", Arrival(3, NORTH, 240.0))
    assert isinstance(likelihood, JunctionLikelihood)
    assert (likelihood.finished, likelihood.readings) == (True, 0)
    assert not hear(classifier, "stakes/junction", stakes(flat_cost_s()))


def test_stakes_hold_for_every_question_of_their_visit_and_for_no_other() -> None:
    regret_s = flat_cost_s(400.0)
    classifier = the_classifier()
    first = on_the_way(classifier)
    (again,) = hear(classifier, "stakes/junction", stakes(regret_s))
    assert isinstance(again, SensingDecision)
    running = int(again.next_detector[0])
    hear(classifier, "percept/arrival", Arrival(3, NORTH, 240.0))
    asked = AskedSensing(8, 3, 1, 0, 40 * 10**9)
    (then,) = hear(classifier, "asked/sensing", asked)
    assert isinstance(then, SensingDecision)
    expected = choose(PRIOR, (), running, NORTH, MODEL, regret_s, LOOK_AHEAD[-1])
    assert then.worth_s.tobytes() == expected.worth_s.tobytes()
    # the branch decided is taken
    hear(classifier, "reading/feature", Reading(3, 1, *divmod(running, 8), 0.5, 0, 8))
    elsewhere = the_classifier()
    hear(elsewhere, "stakes/junction", stakes(NOTHING_AT_STAKE, visit=2))
    assert on_the_way(elsewhere).worth_s.tobytes() == first.worth_s.tobytes()
    assert not hear(elsewhere, "stakes/junction", stakes(NOTHING_AT_STAKE, visit=4))


def test_less_at_stake_makes_it_stop_earlier() -> None:
    prices = (0.0, 50.0, 400.0, 20_000.0, 100_000.0)
    worth = []
    for price in prices:
        classifier = the_classifier()
        on_the_way(classifier)
        (again,) = hear(classifier, "stakes/junction", stakes(flat_cost_s(price)))
        assert isinstance(again, SensingDecision)
        worth.append(float(again.worth_s[0]))
    assert worth == sorted(worth)
    assert worth[0] == worth[1] == 0.0 < worth[2]


def test_doubt_of_its_own_readings_multiplies_what_is_at_stake() -> None:
    answers = []
    for doubt, price in ((10.0, 400.0), (1.0, 4000.0)):
        classifier = the_classifier(doubt=doubt)
        on_the_way(classifier)
        answers += hear(classifier, "stakes/junction", stakes(flat_cost_s(price)))
    one, other = (a for a in answers if isinstance(a, SensingDecision))
    assert one.worth_s.tobytes() == other.worth_s.tobytes()


def test_the_price_of_its_own_is_never_exceeded() -> None:
    classifier = the_classifier(doubt=10.0)
    first = on_the_way(classifier)
    (again,) = hear(classifier, "stakes/junction", stakes(flat_cost_s(99_000.0)))
    assert isinstance(again, SensingDecision)
    assert again.worth_s.tobytes() == first.worth_s.tobytes()


def test_it_does_not_listen_where_that_is_set() -> None:
    classifier = the_classifier(heeds_stakes=False)
    on_the_way(classifier)
    assert not hear(classifier, "stakes/junction", stakes(NOTHING_AT_STAKE))


def test_the_second_answer_is_through_before_the_first_is_acted_on() -> None:
    costs = CostModel("a test", {"sensing": Rate(0.0, 10_000.0)})
    for ahead in LOOK_AHEAD[1:]:  # as much time as this look-ahead takes, and none to spare
        needs_ns = 10_000 * cells_before((), None, NORTH, MODEL, ahead)
        turn = Turn(10**15 - needs_ns, costs, ("decider", 0))
        classifier = the_classifier()
        on_the_way(classifier, 10**15)
        classifier.handlers["stakes/junction"](stakes(flat_cost_s(400.0)), turn)
        assert turn.said
        assert turn.start_ns + turn.cost_ns <= 10**15 - SPARE_NS


@pytest.mark.parametrize(("spare_ns", "answers"), [(0, 1), (-1, 0)])
def test_a_second_answer_is_not_begun_where_it_might_be_late(spare_ns: int, answers: int) -> None:
    costs = CostModel("a test", {"sensing": Rate(0.0, 10_000.0)})
    until_ns = 240 * 10**9
    classifier = the_classifier()
    on_the_way(classifier, until_ns)
    needs_ns = 10_000 * cells_before((), None, NORTH, MODEL, LOOK_AHEAD[0])
    at_ns = until_ns - needs_ns - SPARE_NS - spare_ns
    assert (
        len(hear(classifier, "stakes/junction", stakes(NOTHING_AT_STAKE), costs, at_ns)) == answers
    )
