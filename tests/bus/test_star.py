"""A real zenoh star: what is hostile, late, lost or frozen, and what a run makes of it."""

from __future__ import annotations

import queue
import threading
from typing import Any

import msgpack
import pytest

from bus import link
from bus.inbox import GapError, LostPayloadError
from bus.messages import Refused, Span
from bus.topics import DETECTORS, REACTOR, SENSOR, TOPICS
from bus.turns import Turn
from bus.wire import Sent
from tests.bus.made_up import bits
from tests.bus.star import SECOND_NS, Ran, Star, toys

LONG_S = 20.0


@pytest.fixture(scope="module")
def clean() -> Ran:
    """A run that nobody disturbs."""
    return Star().play()


def written(ran: Ran) -> list[Any]:
    """The log but for refusals, to the last bit."""
    return [
        (s.topic, s.id, s.previous, s.said_ns, s.parents, bits(s.message))
        for s in ran.written
        if s.topic != "health/refused"
    ]


def refused(ran: Ran) -> list[Refused]:
    return [s.message for s in ran.written if isinstance(s.message, Refused)]


def same(ran: Ran, clean: Ran) -> None:
    assert ran.dones == clean.dones
    assert [s.id for s in ran.heard] == [s.id for s in clean.heard]
    assert written(ran) == written(clean)
    assert (ran.lost, ran.errors, ran.unwritten) == ([], {}, [])


def test_a_run_is_whole(clean: Ran) -> None:
    assert (clean.lost, clean.errors, clean.refusals) == ([], {}, 0)
    topics = [s.topic for s in clean.heard]
    assert topics.count("command/attention") == topics.count("command/motion") == 12
    assert len([s for s in clean.written if isinstance(s.message, Span)]) == sum(
        len(done.handled) for done in clean.dones
    )


def test_the_same_again(clean: Ran) -> None:
    same(Star().play(), clean)


class Hostile:
    """Puts bytes onto keys, one a round, and waits until the hub has heard what came of it."""

    def __init__(self, what: list[tuple[str, bytes]]) -> None:
        self._what = what

    def __call__(self, star: Star, ping: int) -> None:
        if 2 <= ping < 2 + len(self._what):
            put_and_wait(star, [self._what[ping - 2]])


def put_and_wait(star: Star, what: list[tuple[str, bytes]]) -> None:
    """Put each, then wait for as many refusals, or for itself where the hub refuses it."""
    came: queue.SimpleQueue[tuple[str, bytes]] = queue.SimpleQueue()
    to_hub = {key for key, _ in what} & {"done", "refused"}
    watched = f"{star.keys.root}/{to_hub.pop() if to_hub else 'refused'}"
    watch = link.subscribe(star.session, watched, came.put)
    with link.open_client(star.at) as session:
        for key, data in what:
            link.publisher(session, f"{star.keys.root}/{key}").put(data)
        for _ in what:
            came.get(timeout=LONG_S)
    watch.undeclare()  # type: ignore[no-untyped-call]


ENVELOPE = ("world", 99, 98, 0, ())
GARBAGE = [
    ("t/percept/sonar", b"\xc1garbage"),
    ("t/belief/ranges", b""),
    ("t/belief/ranges", msgpack.packb(("intruder", 7, -1, 0, (), (1,)))),
    ("t/command/attention", msgpack.packb(("reactor", 55, 3, 0, (), ("soon",)))),
    ("t/weather/rain", msgpack.packb((*ENVELOPE, (1,)))),
    ("grant/sensor", b"\x01"),
    ("t/.commit", b"\x01\x02"),
]


def test_garbage_is_refused_counted_logged_and_does_no_harm(clean: Ran) -> None:
    ran = Star(disturb=Hostile(GARBAGE)).play()
    same(ran, clean)
    assert ran.refusals == len(GARBAGE)
    found = refused(ran)
    assert [(r.topic, r.source, r.sequence, r.count) for r in found] == [
        ("percept/sonar", "", -1, 1),
        ("belief/ranges", "", -1, 2),
        ("belief/ranges", "intruder", 7, 3),
        ("command/attention", "reactor", 55, 4),
        ("weather/rain", "world", 99, 5),
        ("grant", "", -1, 6),
        ("commit", "", -1, 7),
    ]
    assert found[2].reason == "FieldError: found source 'intruder', expected 'sensor'"
    assert found[4].reason == "FieldError: unknown topic"


def test_a_refusal_stands_in_the_log_at_the_time_of_the_run() -> None:
    ran = Star(disturb=Hostile(GARBAGE[:1])).play()
    (at,) = [k for k, s in enumerate(ran.written) if s.topic == "health/refused"]
    said = ran.written[at]
    assert (said.source, said.sequence, said.previous) == ("bus", 0, -1)
    assert 2 * SECOND_NS <= said.said_ns < 12 * SECOND_NS
    assert ran.written[at - 1].said_ns <= said.said_ns <= ran.written[at + 1].said_ns


@pytest.mark.parametrize(
    ("key", "data", "topic"),
    [
        ("done", b"\x07", "done"),
        ("done", msgpack.packb(("sensor", 5, (), ())), "done"),
        ("done", msgpack.packb(("nobody", 5, (), ())), "done"),
        ("refused", b"\x07", "refused"),
    ],
    ids=["garbage", "no such grant", "no such process", "garbage for a refusal"],
)
def test_what_is_no_answer_to_the_hub_is_refused(
    clean: Ran, key: str, data: bytes, topic: str
) -> None:
    ran = Star(disturb=Hostile([(key, data)])).play()
    same(ran, clean)
    assert [r.topic for r in refused(ran)] == [topic]


def test_every_topic_can_be_spoilt_at_once(clean: Ran) -> None:
    """A burst of garbage on every topic of the table in one round."""

    def burst(star: Star, ping: int) -> None:
        if ping == 3:
            put_and_wait(star, [(f"t/{topic}", b"\x93\x01") for topic in TOPICS])

    ran = Star(disturb=burst).play(12)
    same(ran, clean)
    assert sorted(r.topic for r in refused(ran)) == sorted(TOPICS)


# Late, lost, down, frozen.


def test_a_payload_behind_its_grant_is_waited_for(clean: Ran) -> None:
    def late(star: Star, sent: Sent) -> None:
        if sent.sequence == 4:
            threading.Timer(0.4, star.hub.put, (sent,)).start()
        else:
            star.hub.put(sent)

    same(Star(put=late).play(), clean)


def test_a_payload_that_never_comes_is_an_error_that_names_it() -> None:
    def lose(star: Star, sent: Sent) -> None:
        if sent.sequence != 4:
            star.hub.put(sent)

    ran = Star(put=lose, payload_patience_s=0.3).play()
    assert isinstance(ran.errors[SENSOR], LostPayloadError)
    assert str(ran.errors[SENSOR]) == (
        "sensor: granted [('world', 4)] at 4001000000 ns, but they did not come within 0.3 s"
    )
    assert ran.lost == [(SENSOR, "down")]
    assert ran.unwritten == [("world", 4)]
    assert ("world", 5) in [s.id for s in ran.written], "the recorder goes on"


def test_a_gap_is_an_error_that_names_both_numbers() -> None:
    def skip(star: Star, sent: Sent) -> None:
        star.hub.put(Sent(**{**_fields(sent), "previous": 2}) if sent.sequence == 4 else sent)

    ran = Star(put=skip).play()
    assert isinstance(ran.errors[SENSOR], GapError)
    assert str(ran.errors[SENSOR]) == (
        "percept/sonar from world: message 4 follows 2, but the last one received was 3"
    )
    assert ran.lost == [(SENSOR, "down")]


def _fields(sent: Sent) -> dict[str, Any]:
    return {name: getattr(sent, name) for name in Sent.__slots__}


def test_a_process_that_dies_is_noticed_and_the_others_go_on() -> None:
    modules = toys()
    work = modules[REACTOR].handlers["belief/ranges"]

    def dies(ranges: Any, turn: Turn) -> None:
        if ranges.ping == 5:
            raise ZeroDivisionError("a bug")
        work(ranges, turn)

    modules[REACTOR].handlers = {"belief/ranges": dies}
    ran = Star(modules).play()
    assert ran.lost == [(REACTOR, "down")]
    assert isinstance(ran.errors[REACTOR], ZeroDivisionError)
    topics = [s.topic for s in ran.heard]
    assert topics.count("command/attention") == 5
    assert topics.count("command/motion") == 12


def test_a_process_that_does_not_answer_is_frozen() -> None:
    modules = toys()
    work = modules[DETECTORS].handlers["belief/scan"]
    over = threading.Event()

    def freezes(ranges: Any, turn: Turn) -> None:
        if ranges.ping == 5:
            with link.open_client(star.at) as session:
                noise = link.publisher(session, star.keys.topic("command/attention"))
                for _ in range(100):  # noise must not make the hub more patient
                    noise.put(b"noise")
                    if over.wait(0.1):
                        break
        work(ranges, turn)

    modules[DETECTORS].handlers = {"belief/scan": freezes}

    def thaw(_: Star, ping: int) -> None:
        if ping == 8:
            over.set()

    star = Star(modules, disturb=thaw, hub_patience_s=0.5)
    ran = star.play()
    assert ran.lost == [(DETECTORS, "frozen")]
    topics = [s.topic for s in ran.heard]
    assert topics.count("command/motion") == 5, "what it says when it thaws is not taken"
    assert topics.count("command/attention") == 12
