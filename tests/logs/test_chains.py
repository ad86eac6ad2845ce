"""Chains of made-up messages: every time on the way is known."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from bus.messages import LedgerEntry
from logs.ancestry import ancestors
from logs.chains import Chain, Chains, DataAge, Hop, chain_of
from tests.logs.made_index import MadeIndex

HOP_NS = 100


def _made() -> tuple[MadeIndex, Chain]:
    """Sonar at 1000 to the sensor, its ranges to the reactor, its decision to the world."""
    index = MadeIndex()
    before = index.say("percept/sonar", "world", 4, 400)
    sonar = index.say("percept/sonar", "world", 5, 1000)
    index.handle("sensor", sonar, 1100, 1150)
    ranges = index.say("belief/ranges", "sensor", 2, 1150, sonar.id, before.id)
    index.handle("reactor", ranges, 1300, 1400)  # heard at 1250, 50 of waiting
    decision = index.say("decision/reaction", "reactor", 7, 1400, ranges.id)
    index.handle("world", decision, 1500, 1500)
    return index, chain_of(index, ancestors(index, decision), HOP_NS)


def test_a_chain_is_split_hop_by_hop() -> None:
    _, chain = _made()
    assert chain.hops == (
        Hop("percept/sonar", "world", 5, "sensor", 1000, 100, 0, 50),
        Hop("belief/ranges", "sensor", 2, "reactor", 1150, 100, 50, 100),
        Hop("decision/reaction", "reactor", 7, "world", 1400, 100, 0, 0),
    )
    assert (chain.began_ns, chain.heard_ns, chain.response_ns) == (1000, 1500, 500)
    assert chain.topics == ("percept/sonar", "belief/ranges", "decision/reaction")
    assert chain.whole
    assert chain.longest is not None
    assert chain.longest[1:] == ("transport", 100)  # the first of the longest parts


def test_the_age_is_that_of_all_percepts_that_went_in() -> None:
    _, chain = _made()
    assert chain.age == DataAge(percepts=2, oldest_ns=1000, newest_ns=400)


def test_a_chain_with_a_message_missing_is_cut_short_there() -> None:
    index, _ = _made()
    del index.nodes["world", 5]
    decision = index.nodes["reactor", 7]
    made = ancestors(index, decision)
    chain = chain_of(index, made, HOP_NS)
    assert made.unknown == 1
    assert not chain.whole
    assert [hop.topic for hop in chain.hops] == ["belief/ranges", "decision/reaction"]


def test_a_chain_with_a_handler_missing_is_cut_short_there() -> None:
    index, _ = _made()
    del index.spans["reactor", ("sensor", 2)]
    chain = chain_of(index, ancestors(index, index.nodes["reactor", 7]), HOP_NS)
    assert (chain.whole, len(chain.hops)) == (False, 1)


def test_a_decision_that_nobody_heard_ends_when_it_was_said() -> None:
    index, _ = _made()
    del index.spans["world", ("reactor", 7)]
    chain = chain_of(index, ancestors(index, index.nodes["reactor", 7]), HOP_NS)
    assert (chain.heard_ns, chain.response_ns) == (None, 400)


def _entry(decision: int, kind: str, decided_ns: int, slack_ns: int) -> LedgerEntry:
    return LedgerEntry(decision, kind, 1, 0, 0, decided_ns, slack_ns, 0, 0, 0, "", "")


def test_the_ledger_finds_its_chains_and_the_latest_comes_first() -> None:
    index, reaction = _made()
    path = index.say("decision/path", "decider", 0, 2000)
    index.handle("world", path, 2100, 2100)
    chains = Chains(index, HOP_NS)
    chains.decided(ancestors(index, path), 3)
    chains.decided(ancestors(index, index.nodes["reactor", 7]), None)
    chains.catch_up()
    entries = [_entry(1, "reaction", 1500, 20), _entry(3, "path", 2100, -5)]
    entries += [_entry(9, "path", -1, -100), _entry(8, "reaction", 1501, 7)]  # never; not it
    found = chains.settled(entries)
    assert [(one.decision, one.slack_ns) for one in found] == [(3, -5), (1, 20)]
    assert found[1].chain == reaction


def test_a_chain_waits_for_the_world() -> None:
    index, _ = _made()
    span = index.spans.pop(("world", ("reactor", 7)))
    chains = Chains(index, HOP_NS)
    chains.decided(ancestors(index, index.nodes["reactor", 7]), 1)
    chains.catch_up()
    assert chains.settled([_entry(1, "reaction", 1500, 0)]) == ()
    index.spans["world", ("reactor", 7)] = span
    chains.catch_up()
    (found,) = chains.settled([_entry(1, "reaction", 1500, 0)])
    assert found.chain.heard_ns == 1500


@given(
    st.lists(st.tuples(st.integers(0, 10**12), st.integers(0, 10**12)), min_size=1, max_size=8),
    st.integers(1, 10**9),
)
def test_the_hops_add_up_and_nobody_waits_less_than_nothing(
    hops: list[tuple[int, int]], hop_ns: int
) -> None:
    index = MadeIndex()
    node = index.say("percept/sonar", "p0", 0, 5)
    for k, (queueing_ns, computing_ns) in enumerate(hops, start=1):
        start_ns = node.said_ns + hop_ns + queueing_ns
        index.handle(f"p{k}", node, start_ns, start_ns + computing_ns)
        node = index.say("belief/pose", f"p{k}", k, start_ns + computing_ns, node.id)
    index.handle("world", node, node.said_ns + hop_ns, node.said_ns + hop_ns)
    chain = chain_of(index, ancestors(index, node), hop_ns)
    assert sum(hop.total_ns for hop in chain.hops) == chain.response_ns
    assert [(hop.queueing_ns, hop.computing_ns) for hop in chain.hops[:-1]] == hops
    assert all(hop.queueing_ns >= 0 and hop.transport_ns == hop_ns for hop in chain.hops)
