"""Turns: what a module says and does comes out at the right time, with the right numbers."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bus.coordinator import Done, Grant
from bus.costs import CostModel, Rate
from bus.fields import FieldError
from bus.messages import ActionEnded, JunctionPrior, Odometry, Ranges, Sonar
from bus.protocol import pack_done, unpack_done
from bus.turns import Handler, Turn, Voice, Worker
from bus.wire import Sent

COSTS = CostModel("made up", {"echo": Rate(5.0, 2.0)}, {"scan": 100})


class Sensing:
    """Takes ``ping`` cells for each echo and says as many ranges as the action says."""

    @property
    def handlers(self) -> Mapping[str, Handler]:
        return {"percept/sonar": self._sonar, "percept/odometry": self._odometry}

    def _sonar(self, sonar: Sonar, turn: Turn) -> None:
        turn.work("echo", sonar.ping)
        for _ in range(sonar.action):
            turn.say(Ranges(sonar.ping, 0, np.zeros(1), np.zeros(1), np.zeros(1), 0.0))

    def _odometry(self, _: Odometry, turn: Turn) -> None:
        turn.say(
            Ranges(0, 0, np.zeros(1), np.zeros(1), np.zeros(1), 0.0), ("world", 0), ("world", 3)
        )


def echo(sequence: int, cells: int, answers: int) -> Sent:
    sonar = Sonar(cells, answers, 0, np.zeros(1))
    return Sent("percept/sonar", "world", sequence, sequence - 1, 0, (), sonar)


def run(time_ns: int, *heard: Sent, worker: Worker | None = None) -> tuple[Done, list[Sent]]:
    worker = worker or Worker("sensor", Sensing(), COSTS)
    return worker.run(Grant("sensor", time_ns, tuple(s.id for s in heard)), heard)


@given(st.lists(st.tuples(st.integers(0, 9), st.integers(0, 3)), max_size=6), st.integers(0, 99))
def test_handlers_follow_back_to_back_and_nothing_is_said_before_their_ends(
    work: list[tuple[int, int]], time_ns: int
) -> None:
    heard = [echo(k, cells, answers) for k, (cells, answers) in enumerate(work)]
    done, said = run(time_ns, *heard)
    assert (done.process, done.time_ns) == ("sensor", time_ns)
    assert [(h.topic, h.source, h.sequence) for h in done.handled] == [
        (s.topic, *s.id) for s in heard
    ]
    at_ns = time_ns
    for handled, (cells, answers) in zip(done.handled, work, strict=True):
        assert (handled.start_ns, handled.end_ns) == (at_ns, at_ns + 5 + 2 * cells)
        assert (handled.cells, handled.said) == (cells, answers)
        at_ns = handled.end_ns
    ends = [h.end_ns for h in done.handled for _ in range(h.said)]
    parents = [((h.source, h.sequence),) for h in done.handled for _ in range(h.said)]
    assert [s.said_ns for s in said] == ends
    assert [s.parents for s in said] == parents
    assert [(s.topic, s.source, s.sequence, s.said_ns) for s in said] == [
        (s.topic, s.source, s.sequence, s.said_ns) for s in done.said
    ]
    assert [s.sequence for s in said] == list(range(len(said)))
    assert [s.previous for s in said] == list(range(-1, len(said) - 1))


def test_numbers_go_on_from_turn_to_turn() -> None:
    worker = Worker("sensor", Sensing(), COSTS)
    run(0, echo(0, 1, 2), worker=worker)
    _, said = run(50, echo(1, 1, 1), worker=worker)
    assert (said[0].sequence, said[0].previous) == (2, 1)


def test_the_message_handled_is_the_first_parent() -> None:
    odometry = Sent("percept/odometry", "world", 7, -1, 0, (), Odometry(0.0, 0.0, 0.0))
    _, said = run(0, odometry)
    assert said[0].parents == (("world", 7), ("world", 0), ("world", 3))


def test_a_turn_knows_how_much_time_is_left() -> None:
    turn = Turn(1000, COSTS, ("world", 3))
    assert turn.left_ns(1500) == 500
    turn.work("echo", 10)
    turn.work("scan", 3)
    assert (turn.cells, turn.cost_ns) == (13, 25 + 100)
    assert turn.left_ns(1500) == 375
    assert turn.works == [("echo", 10), ("scan", 3)]


def test_one_count_for_a_process_one_link_for_a_topic() -> None:
    voice = Voice("world")
    found = [
        voice.sent(message, 0, ())
        for message in (ActionEnded(1), Odometry(0.0, 0.0, 0.0), ActionEnded(2), ActionEnded(3))
    ]
    assert [(s.sequence, s.previous) for s in found] == [(0, -1), (1, -1), (2, 0), (3, 2)]


def test_what_was_said_can_be_changed_no_more() -> None:
    ranges_m = np.zeros(3)
    Voice("world").sent(Sonar(1, 2, 3, ranges_m), 0, ())
    with pytest.raises(ValueError, match="read-only"):
        ranges_m[0] = 1.0


def test_what_listeners_would_refuse_cannot_be_said() -> None:
    with pytest.raises(FieldError) as error:
        Voice("geographer").sent(JunctionPrior(1, 0, 0, 1, np.full(16, 0.5)), 0, ())
    assert str(error.value) == (
        "geographer may not say this on prior/junction: field 'prior': sums to 8, expected 1"
    )


class Chatty:
    """Prints what it hears."""

    @property
    def handlers(self) -> Mapping[str, Handler]:
        return {"percept/sonar": lambda said, _turn: print("ping", said.ping)}


def test_what_a_handler_prints_goes_into_the_log_with_its_work() -> None:
    worker = Worker("sensor", Chatty(), COSTS)
    done, _ = run(9, echo(0, 7, 0), echo(1, 8, 0), worker=worker)
    assert [h.printed for h in done.handled] == ["ping 7\n", "ping 8\n"]
    assert unpack_done(pack_done(done)) == done
