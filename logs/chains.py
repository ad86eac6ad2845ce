"""What led to each decision, hop by hop, and how old the data were that it was made from.

A *chain* goes back from a decision by the message that triggered each maker: the one whose
coming started its handler, hence the one that decided when the answer came. It ends at a message
that nothing triggered: a percept, or a question. A *hop* is one message of it on its way into
the next: said, heard (transport), taken up (queueing), worked on (computing). The parts of all
hops add up to the response time of the chain, to the nanosecond.
"""

from __future__ import annotations

from dataclasses import dataclass

from bus.messages import LedgerEntry
from bus.topics import WORLD
from logs.ancestry import Ancestors, Index, Node
from logs.decisions import NEVER

PERCEPT = "percept/"


@dataclass(frozen=True)
class Hop:
    """One message on its way to one process; all times in simulated nanoseconds.

    ``queueing_ns`` is how long it waited there, heard but not taken up, because the process (or
    the processor that it shares) was busy.
    """

    topic: str
    source: str
    sequence: int
    process: str
    said_ns: int
    transport_ns: int
    queueing_ns: int
    computing_ns: int

    @property
    def total_ns(self) -> int:
        """From being said to the end of its handler."""
        return self.transport_ns + self.queueing_ns + self.computing_ns


@dataclass(frozen=True)
class DataAge:
    """How old the percepts were that a decision was made from, when it was said."""

    percepts: int
    oldest_ns: int
    newest_ns: int


@dataclass(frozen=True)
class Chain:
    """What led to one decision, the first cause first.

    ``heard_ns`` is when the world took it up, None if it never did. ``whole`` says whether every
    message and handler on the way is in the log; where it is not, the chain begins later. ``age``
    is None where no percept went into the decision.
    """

    topic: str
    source: str
    sequence: int
    said_ns: int
    heard_ns: int | None
    hops: tuple[Hop, ...]
    whole: bool
    age: DataAge | None

    @property
    def began_ns(self) -> int:
        """When the first message of the chain was said."""
        return self.hops[0].said_ns if self.hops else self.said_ns

    @property
    def response_ns(self) -> int:
        """From its first message until the decision was heard, or said if it was not."""
        return (self.said_ns if self.heard_ns is None else self.heard_ns) - self.began_ns

    @property
    def topics(self) -> tuple[str, ...]:
        """The topics on the way, the decision's last."""
        return (*(hop.topic for hop in self.hops if hop.topic != self.topic), self.topic)

    @property
    def longest(self) -> tuple[Hop, str, int] | None:
        """The part that took longest: its hop, what it was, its time in ns."""
        parts = [
            (hop, name, took_ns)
            for hop in self.hops
            for name, took_ns in (
                ("transport", hop.transport_ns),
                ("queueing", hop.queueing_ns),
                ("computing", hop.computing_ns),
            )
        ]
        return max(parts, key=lambda part: part[2], default=None)


@dataclass(frozen=True)
class DecisionChain:
    """The chain of a decision that the ledger has; ``slack_ns`` is negative for a late one."""

    decision: int
    kind: str
    visit: int
    asked_ns: int
    until_ns: int
    slack_ns: int
    chain: Chain


def transport_ns(said_ns: int, start_ns: int, hop_ns: int) -> int:
    """How much of the time from being said to being taken up was transport."""
    return min(hop_ns, start_ns - said_ns)


def chain_of(index: Index, made: Ancestors, hop_ns: int) -> Chain:
    """The chain of a decision. ``hop_ns`` is how long a message takes on the bus."""
    decision = made.of
    hops: list[Hop] = []
    last = _hop(index, decision, WORLD, hop_ns)
    if last is not None:
        hops.append(last)
    node, whole = decision, True
    while node.parents:
        trigger = index.find(node.parents[0])
        hop = _hop(index, trigger, node.source, hop_ns) if trigger is not None else None
        if trigger is None or hop is None:
            whole = False
            break
        hops.append(hop)
        node = trigger
    heard_ns = last.said_ns + last.transport_ns + last.queueing_ns if last else None
    return Chain(
        decision.topic,
        decision.source,
        decision.sequence,
        decision.said_ns,
        heard_ns,
        tuple(reversed(hops)),
        whole,
        data_age(made),
    )


def _hop(index: Index, node: Node, process: str, hop_ns: int) -> Hop | None:
    span = index.span(process, node.id)
    if span is None:
        return None
    start_ns, end_ns = span
    transport = transport_ns(node.said_ns, start_ns, hop_ns)
    return Hop(
        topic=node.topic,
        source=node.source,
        sequence=node.sequence,
        process=process,
        said_ns=node.said_ns,
        transport_ns=transport,
        queueing_ns=start_ns - node.said_ns - transport,
        computing_ns=end_ns - start_ns,
    )


def data_age(made: Ancestors) -> DataAge | None:
    """The age of the percepts among a decision's ancestors at the moment it was said."""
    said_ns = [a.node.said_ns for a in made.each if a.node.topic.startswith(PERCEPT)]
    if not said_ns:
        return None
    at_ns = made.of.said_ns
    return DataAge(len(said_ns), at_ns - min(said_ns), at_ns - max(said_ns))


class Chains:
    """Gathers the chains of one log.

    A chain is made when the world has taken the decision up, so that nothing else of it is kept.
    """

    def __init__(self, index: Index, hop_ns: int) -> None:
        self._index = index
        self._hop_ns = hop_ns
        self._open: list[tuple[Ancestors, int | None]] = []
        self._by_number: dict[int, Chain] = {}
        self._by_time: dict[tuple[str, int], Chain] = {}

    def decided(self, made: Ancestors, number: int | None) -> None:
        """A decision was said; ``number`` is the question it answers, None if it does not say."""
        self._open.append((made, number))

    def catch_up(self, *, last: bool = False) -> None:
        """Make the chains of decisions that were heard meanwhile; at last, of all the others."""
        still_open: list[tuple[Ancestors, int | None]] = []
        for made, number in self._open:
            if last or self._index.span(WORLD, made.of.id) is not None:
                self._make(made, number)
            else:
                still_open.append((made, number))
        self._open = still_open

    def _make(self, made: Ancestors, number: int | None) -> None:
        chain = chain_of(self._index, made, self._hop_ns)
        if number is not None:
            self._by_number.setdefault(number, chain)  # the first answer is the one that counts
        elif chain.heard_ns is not None:
            self._by_time[chain.topic, chain.heard_ns] = chain

    def settled(self, ledger: list[LedgerEntry]) -> tuple[DecisionChain, ...]:
        """The chains of the decisions in the ledger that came, the latest first.

        A reaction does not name its question; it is the one heard at the moment of the entry.
        """
        found: list[DecisionChain] = []
        for entry in ledger:
            if entry.decided_ns == NEVER:
                continue
            topic = f"decision/{entry.kind}"
            chain = self._by_number.get(entry.decision) or self._by_time.get(
                (topic, entry.decided_ns)
            )
            if chain is not None:
                found.append(
                    DecisionChain(
                        entry.decision,
                        entry.kind,
                        entry.visit,
                        entry.asked_ns,
                        entry.until_ns,
                        entry.slack_ns,
                        chain,
                    )
                )
        return tuple(sorted(found, key=lambda one: (one.slack_ns, one.decision)))
