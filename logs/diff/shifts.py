"""By which hops the slack of a decision changed from one run to another."""

from __future__ import annotations

from dataclasses import dataclass

from logs.chains import DecisionChain, Hop

AVAILABLE = "time available"
ANOTHER_WAY = "another way"


@dataclass(frozen=True)
class Shift:
    """One part of a change of slack: ``change_ns`` is how much longer it took, or shorter.

    ``part`` is transport, queueing or computing, of a message of ``topic`` in ``process``;
    :data:`AVAILABLE` is the time from the chain's first message to the deadline, of which more
    is better; :data:`ANOTHER_WAY` a chain of other hops, whose parts cannot be compared.
    """

    part: str
    topic: str
    process: str
    change_ns: int


def shifts(base: DecisionChain, new: DecisionChain) -> tuple[Shift, ...]:
    """What changed, the largest first: slack grows by what is available less all else."""
    available_ns = _available_ns(new) - _available_ns(base)
    found = [Shift(AVAILABLE, "", "", available_ns)] if available_ns else []
    if _way(base) != _way(new):
        response_ns = new.chain.response_ns - base.chain.response_ns
        found.append(Shift(ANOTHER_WAY, " > ".join(new.chain.topics), "", response_ns))
    else:
        for one, two in zip(base.chain.hops, new.chain.hops, strict=True):
            found += _of_hop(one, two)
    return tuple(sorted(found, key=lambda shift: -abs(shift.change_ns)))


def _available_ns(one: DecisionChain) -> int:
    return one.until_ns - one.chain.began_ns


def _way(one: DecisionChain) -> list[tuple[str, str]]:
    return [(hop.topic, hop.process) for hop in one.chain.hops]


def _of_hop(one: Hop, two: Hop) -> list[Shift]:
    parts = {
        "transport": two.transport_ns - one.transport_ns,
        "queueing": two.queueing_ns - one.queueing_ns,
        "computing": two.computing_ns - one.computing_ns,
    }
    return [Shift(part, two.topic, two.process, ns) for part, ns in parts.items() if ns]
