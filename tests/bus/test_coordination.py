"""What holds of every network of talking processes under the virtual clock."""

from __future__ import annotations

import random
from collections import Counter

from hypothesis import given, settings
from hypothesis import strategies as st

from bus.coordinator import Done, Said
from tests.bus.timetable import Actor, Played, Stage

TOPICS = ("p", "q", "r", "s")
NAMES = ("a", "b", "c", "d", "e")
some_topics = st.lists(st.sampled_from(TOPICS), max_size=2, unique=True).map(tuple)


@st.composite
def casts(draw: st.DrawFn) -> tuple[Actor, ...]:
    names = NAMES[: draw(st.integers(1, len(NAMES)))]
    costs = st.lists(st.integers(0, 60), min_size=1, max_size=3).map(tuple)
    return tuple(
        Actor(
            name,
            draw(st.integers(0, 3)),
            draw(some_topics),
            draw(costs),
            draw(some_topics),
        )
        for name in names
    )


@st.composite
def scripts(draw: st.DrawFn) -> list[Said]:
    at_ns = 0
    said = []
    for sequence in range(draw(st.integers(1, 6))):
        at_ns += draw(st.integers(0, 40))
        said.append(Said(draw(st.sampled_from(TOPICS)), "w", sequence, at_ns))
    return said


@st.composite
def stages(draw: st.DrawFn) -> Stage:
    return Stage(
        draw(casts()),
        draw(scripts()),
        hop_ns=draw(st.integers(1, 20)),
        processors=draw(st.sampled_from([None, 1, 2])),
        most_said=8,
    )


def again(stage: Stage) -> Stage:
    """The same play, not yet begun."""
    return Stage(
        stage.cast,
        stage.script,
        stage.hop_ns,
        stage.processors,
        stage.apart,
        stage.most_said,
    )


def handlers(played: Played) -> list[tuple[str, int, int, tuple[str, int]]]:
    return [
        (done.process, h.start_ns, h.end_ns, (h.source, h.sequence))
        for done in played.dones
        for h in done.handled
    ]


@given(stages())
@settings(max_examples=150, deadline=None)
def test_nothing_is_handled_before_it_is_heard(stage: Stage) -> None:
    played = stage.play()
    said_ns = {(s.source, s.sequence): s.said_ns for s in played.said}
    for _, start_ns, _, name in handlers(played):
        assert start_ns >= said_ns[name] + stage.hop_ns


@given(stages())
@settings(max_examples=150, deadline=None)
def test_everything_said_is_handled_once_by_each_who_hears_it(stage: Stage) -> None:
    played = stage.play()
    handled = Counter((process, name) for process, _, _, name in handlers(played))
    hears = {
        (actor.name, (said.source, said.sequence))
        for actor in stage.cast
        for said in played.said
        if said.topic in actor.hears
    }
    assert handled == dict.fromkeys(hears, 1)


@given(stages())
@settings(max_examples=150, deadline=None)
def test_nobody_hears_one_source_out_of_order(stage: Stage) -> None:
    heard: dict[tuple[str, str], list[int]] = {}
    for process, _, _, (source, sequence) in handlers(stage.play()):
        heard.setdefault((process, source), []).append(sequence)
    for sequences in heard.values():
        assert sequences == sorted(sequences)


@given(stages())
@settings(max_examples=150, deadline=None)
def test_each_process_hears_in_the_total_order(stage: Stage) -> None:
    played = stage.play()
    rank = {actor.name: actor.priority for actor in stage.cast} | {"w": 0}
    key = {
        (s.source, s.sequence): (s.said_ns, rank[s.source], s.source, s.sequence)
        for s in played.said
    }
    for actor in stage.cast:
        order = [key[name] for process, _, _, name in handlers(played) if process == actor.name]
        assert order == sorted(order)


@given(stages())
@settings(max_examples=150, deadline=None)
def test_handlers_of_a_process_never_overlap(stage: Stage) -> None:
    free_ns: dict[str, int] = {}
    for process, start_ns, end_ns, _ in handlers(stage.play()):
        assert start_ns >= free_ns.get(process, 0)
        free_ns[process] = end_ns


@given(stages())
@settings(max_examples=150, deadline=None)
def test_no_more_compute_at_once_than_there_are_processors(stage: Stage) -> None:
    played = stage.play()
    if stage.processors is None:
        return
    turns = [(d.time_ns, d.handled[-1].end_ns) for d in played.dones]
    for at_ns, _ in turns:
        assert sum(start <= at_ns < end for start, end in turns) <= stage.processors


@given(stages())
@settings(max_examples=150, deadline=None)
def test_a_processor_is_never_idle_while_somebody_waits(stage: Stage) -> None:
    if stage.processors is None:
        return
    played = stage.play()
    turns = [(d.time_ns, d.handled[-1].end_ns) for d in played.dones]
    said_ns = {(s.source, s.sequence): s.said_ns for s in played.said}
    free_ns: dict[str, int] = {}
    for done in played.dones:
        first = done.handled[0]
        heard_ns = said_ns[first.source, first.sequence] + stage.hop_ns
        could_ns = max(heard_ns, free_ns.get(done.process, 0))
        free_ns[done.process] = done.handled[-1].end_ns
        for at_ns in range(could_ns, done.time_ns):
            assert sum(start <= at_ns < end for start, end in turns) == stage.processors


@given(stages(), st.randoms(use_true_random=False))
@settings(max_examples=150, deadline=None)
def test_the_order_in_which_dones_come_back_changes_nothing(
    stage: Stage, rng: random.Random
) -> None:
    def shuffled(dones: list[Done]) -> list[Done]:
        return rng.sample(dones, len(dones))

    assert again(stage).play(shuffled).grants == stage.play().grants


@given(stages())
@settings(max_examples=50, deadline=None)
def test_the_same_play_again_is_the_same(stage: Stage) -> None:
    first, second = stage.play(), again(stage).play()
    assert (first.grants, first.dones, first.said) == (second.grants, second.dones, second.said)
