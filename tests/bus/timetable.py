"""Small networks of talking processes, written as tables, played on the coordinator alone."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from bus.coordinator import Coordinator, Done, Grant, Handled, Said


@dataclass(frozen=True)
class Actor:
    """A process: each message it handles costs so much and makes it say one on each topic.

    ``costs_ns`` are taken in turn, again and again from the first.
    """

    name: str
    priority: int
    hears: tuple[str, ...]
    costs_ns: tuple[int, ...]
    says: tuple[str, ...]


@dataclass
class Played:
    """What happened: grants in their order, and every handler and message."""

    grants: list[Grant] = field(default_factory=list)
    dones: list[Done] = field(default_factory=list)
    said: list[Said] = field(default_factory=list)

    @property
    def table(self) -> list[str]:
        """Grants as text: time, process, the messages it may handle."""
        return [
            f"{g.time_ns} {g.process} " + " ".join(f"{s}{n}" for s, n in g.messages)
            for g in self.grants
        ]


def rows(text: str) -> list[list[str]]:
    """The words of each line that has any."""
    return [line.split() for line in text.splitlines() if line.split()]


def lines(text: str) -> list[str]:
    """An expected table of grants."""
    return [" ".join(row) for row in rows(text)]


def actors(text: str) -> tuple[Actor, ...]:
    """Rows of: name, priority, topics heard, cost, topics said; ``-`` for none, commas within."""

    def words(cell: str) -> tuple[str, ...]:
        return () if cell == "-" else tuple(cell.split(","))

    return tuple(
        Actor(name, int(priority), words(hears), tuple(map(int, words(cost))) or (0,), words(says))
        for name, priority, hears, cost, says in rows(text)
    )


def scripted(text: str) -> list[Said]:
    """What is said from outside: rows of time, source, topic, in the order of time."""
    count: dict[str, int] = {}
    found = []
    for at, source, topic in rows(text):
        sequence = count.get(source, 0)
        count[source] = sequence + 1
        found.append(Said(topic, source, sequence, int(at)))
    return found


def in_order(dones: list[Done]) -> list[Done]:
    """Dones as they come."""
    return dones


@dataclass
class Stage:
    """One play: the coordinator, what the actors count, and what has happened."""

    cast: tuple[Actor, ...]
    script: list[Said]
    hop_ns: int = 10
    processors: int | None = None
    apart: tuple[str, ...] = ()
    most_said: int = 20
    """Nobody answers once it has said so many, so that every play ends."""

    def __post_init__(self) -> None:
        topics = sorted({t for actor in self.cast for t in (*actor.hears, *actor.says)})
        hearers = {t: tuple(a.name for a in self.cast if t in a.hears) for t in topics}
        self.coordinator = Coordinator(
            {a.name: a.priority for a in self.cast},
            hearers,
            self.hop_ns,
            self.processors,
            self.apart,
        )
        self.played = Played()
        self._actor = {a.name: a for a in self.cast}
        self._turns = dict.fromkeys(self._actor, 0)
        self._sequence = dict.fromkeys(self._actor, 0)
        for said in self.script:
            if said.source in self._sequence:
                self._sequence[said.source] = said.sequence + 1
        self._topic: dict[tuple[str, int], str] = {}

    def play(self, order: Callable[[list[Done]], list[Done]] = in_order) -> Played:
        """To the end; ``order`` says in which order the dones of a round come back."""
        script = list(self.script)
        while True:
            next_ns = self.coordinator.next_ns()
            if script and (next_ns is None or script[0].said_ns <= next_ns):
                self._say(script.pop(0))
            elif next_ns is None:
                return self.played
            else:
                self._round(next_ns, order)

    def _say(self, said: Said) -> None:
        self._note(said)
        self.coordinator.said(said)

    def _note(self, said: Said) -> None:
        self._topic[said.source, said.sequence] = said.topic
        self.played.said.append(said)

    def _round(self, now_ns: int, order: Callable[[list[Done]], list[Done]]) -> None:
        grants = self.coordinator.grants(now_ns)
        self.played.grants += grants
        dones = [self._handle(grant) for grant in grants]
        self.played.dones += dones
        for done in order(dones):
            self.coordinator.done(done)

    def _handle(self, grant: Grant) -> Done:
        actor = self._actor[grant.process]
        at_ns = grant.time_ns
        handled: list[Handled] = []
        all_said: list[Said] = []
        for source, sequence in grant.messages:
            turn = self._turns[actor.name]
            self._turns[actor.name] = turn + 1
            end_ns = at_ns + actor.costs_ns[turn % len(actor.costs_ns)]
            topics = actor.says if self._sequence[actor.name] < self.most_said else ()
            said = [self._next(actor.name, topic, end_ns) for topic in topics]
            topic = self._topic[source, sequence]
            handled.append(Handled(topic, source, sequence, at_ns, end_ns, 1, len(said)))
            all_said += said
            at_ns = end_ns
        return Done(actor.name, grant.time_ns, tuple(handled), tuple(all_said))

    def _next(self, name: str, topic: str, said_ns: int) -> Said:
        sequence = self._sequence[name]
        self._sequence[name] = sequence + 1
        said = Said(topic, name, sequence, said_ns)
        self._note(said)
        return said
