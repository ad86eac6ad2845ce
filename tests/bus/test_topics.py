"""The table of topics is whole and consistent."""

from __future__ import annotations

import msgspec

from bus import messages as m
from bus.topics import (
    BUS,
    CLOCK,
    MODULES,
    PRIORITY,
    RECORDER,
    TOPIC_OF,
    TOPICS,
    WORLD,
    heard_by,
)


def test_every_message_type_has_one_topic() -> None:
    types = {
        value
        for value in vars(m).values()
        if isinstance(value, type) and issubclass(value, m.Message) and value is not m.Message
    }
    assert set(TOPIC_OF) == types
    assert len(TOPIC_OF) == len(TOPICS)
    assert all(TOPIC_OF[topic.type] is topic for topic in TOPICS.values())


def test_everybody_named_exists() -> None:
    for topic in TOPICS.values():
        assert topic.publisher in (WORLD, *MODULES, CLOCK, BUS)
        assert set(topic.subscribers) <= {WORLD, *MODULES}
        assert topic.publisher not in topic.subscribers, "nobody hears itself"


def test_the_truth_is_heard_by_nobody_but_the_recorder() -> None:
    truths = {topic for topic in TOPICS.values() if topic.name.startswith("truth/")}
    assert truths == {topic for topic in TOPICS.values() if topic.truth}
    assert all(topic.publisher == WORLD and topic.subscribers == () for topic in truths)


def test_the_recorder_hears_all_the_others_what_names_them() -> None:
    assert heard_by(RECORDER) == tuple(TOPICS.values())
    for process in (WORLD, *MODULES):
        assert heard_by(process) == tuple(
            topic for topic in TOPICS.values() if process in topic.subscribers
        )
        assert heard_by(process), f"{process} hears nothing"


def test_the_reactor_is_the_first_of_the_modules() -> None:
    assert MODULES[0] == "reactor"
    assert sorted(PRIORITY, key=PRIORITY.__getitem__) == [WORLD, *MODULES]


def test_messages_are_frozen_and_travel_as_lists() -> None:
    for topic in TOPICS.values():
        config = topic.type.__struct_config__
        assert config.frozen
        assert config.array_like
        assert config.forbid_unknown_fields
        assert all(info.required for info in msgspec.structs.fields(topic.type))
