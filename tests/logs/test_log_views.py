"""What viewers are shown of a run: right places, right words, the same bytes every time."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from foxglove_schemas_protobuf.Log_pb2 import Log
from google.protobuf.descriptor_pb2 import FileDescriptorSet
from google.protobuf.descriptor_pool import DescriptorPool
from google.protobuf.message_factory import GetMessageClass

from bus import messages as m
from bus.grid import Grid
from bus.topics import TOPIC_OF, TOPICS
from bus.wire import Sent
from logs.reader import read_run
from logs.views import VIEWS, Views
from logs.views.floor import Floor
from logs.views.views import IN_WORDS, view_schema
from simworld.building import build, random_connected
from tests.logs.conftest import BUILDING, EPOCH_NS, MakeLog, S, entry, map_belief


def _sent(message: m.Message, said_ns: int = 5 * S) -> Sent:
    topic = TOPIC_OF[type(message)]
    return Sent(topic.name, topic.publisher, 3, -1, said_ns, (), message)


def _view(message: m.Message, views: Views | None = None, topic: str = "") -> Any:
    """The one view (on a topic) of a message, decoded by the schema that is in the log alone."""
    found = (views or Views(EPOCH_NS)).of(_sent(message))
    ((topic, data),) = (view for view in found if not topic or view[0] == topic)
    name, described = view_schema(topic)
    pool = DescriptorPool()
    for file in FileDescriptorSet.FromString(described).file:
        pool.Add(file)
    return GetMessageClass(pool.FindMessageTypeByName(name)).FromString(data)


def _words(message: m.Message) -> tuple[int, str]:
    log = _view(message)
    assert (log.timestamp.seconds, log.timestamp.nanos) == (EPOCH_NS // S + 5, 0)
    topic = TOPIC_OF[type(message)]
    assert (log.name, log.file) == (topic.publisher, topic.name)
    return log.level, log.message


def _wall_set(walls: Any) -> set[tuple[tuple[float, float], ...]]:
    return {tuple(sorted((round(float(x), 6), round(float(y), 6)) for x, y in w)) for w in walls}


def test_the_topics_of_views_are_not_topics_of_the_bus() -> None:
    assert not set(VIEWS) & set(TOPICS)
    assert all(topic.startswith("view/") for topic in VIEWS)
    assert set(TOPICS) >= IN_WORDS


@pytest.mark.parametrize("seed", range(8))
def test_the_walls_are_those_of_the_building(seed: int) -> None:
    """The simulated world's walls join in straight runs; ours are cut at the junctions."""
    rng = np.random.default_rng(seed)
    grid = Grid(int(rng.integers(2, 5)), int(rng.integers(1, 4)))
    columns_m, rows_m = 10.0 * np.arange(grid.columns), 8.0 * np.arange(grid.rows)
    corridors = random_connected(grid, 0.6, rng)
    truth = build(columns_m.tolist(), rows_m.tolist(), corridors, 2.0)
    message = m.TrueBuilding(columns_m, rows_m, 2.0, corridors, 0)
    ours = Floor.of(message).walls_m(corridors.tolist())
    length_m = sum(math.dist(*wall) for wall in ours)
    walls_m = np.hypot(*(truth.walls[:, 2:] - truth.walls[:, :2]).T).sum()
    assert length_m == pytest.approx(walls_m)
    for (x0, y0), (x1, y1) in ours:
        assert truth.clearance_m((x0 + x1) / 2, (y0 + y1) / 2) == pytest.approx(0.0, abs=1e-9)
    assert len(_wall_set(ours)) == len(ours)


def test_the_building_is_drawn_once_with_a_body_that_goes_with_the_robot() -> None:
    scene = _view(BUILDING)
    walls, robot = scene.entities
    assert (walls.frame_id, robot.frame_id, robot.frame_locked) == ("building", "robot", True)
    # three corridors in a row: 6 sides, and 4 junctions with 2, 1, 1, 2 ways out of 16
    assert len(walls.lines[0].points) == 2 * (6 + 16 - 6)
    assert (walls.timestamp.seconds, walls.timestamp.nanos) == (EPOCH_NS // S + 5, 0)
    assert robot.cylinders[0].pose.orientation.w == 1.0


def test_the_robot_is_where_it_is_and_looks_where_it_looks() -> None:
    frame = _view(m.TruePose(1.5, -2.0, math.pi / 2, 3))
    assert (frame.parent_frame_id, frame.child_frame_id) == ("building", "robot")
    assert (frame.translation.x, frame.translation.y, frame.translation.z) == (1.5, -2.0, 0.0)
    assert (frame.rotation.z, frame.rotation.w) == pytest.approx((math.sqrt(0.5), math.sqrt(0.5)))


def test_echoes_are_points_round_the_robot_at_the_time_of_firing() -> None:
    cloud = _view(m.Sonar(0, 0, int(4.5 * S), np.array([1.0, 2.0, np.nan, 4.0])))
    assert cloud.frame_id == "robot"
    assert (cloud.timestamp.seconds, cloud.timestamp.nanos) == (EPOCH_NS // S + 4, S // 2)
    assert [(f.name, f.offset, f.type) for f in cloud.fields] == [
        ("x", 0, 7),
        ("y", 4, 7),
        ("z", 8, 7),
    ]
    points = np.frombuffer(cloud.data, "<f4").reshape(-1, cloud.point_stride // 4)
    assert points == pytest.approx(np.array([[1, 0, 0], [0, 2, 0], [0, -4, 0]]), abs=1e-6)


def test_echoes_are_shown_once_a_second_at_most() -> None:
    views = Views(EPOCH_NS)
    shown = [
        ping
        for ping in range(40)
        if views.of(_sent(m.Sonar(ping, 0, ping * S // 4, np.ones(4)), ping * S // 4))
    ]
    assert shown == list(range(0, 40, 4))


def test_the_belief_is_coloured_by_its_probability() -> None:
    views = Views(EPOCH_NS)
    belief = map_belief(0, [0.9, 0.5, 0.6, 0.0], [[1, 0, 1, 1]], [-2.0])
    belief.junctions[1, 0] = np.eye(16)[3]
    assert views.of(_sent(belief)) == []  # there is nothing to draw it on yet
    views.of(_sent(BUILDING))
    (entity,) = _view(belief, views, "view/belief").entities
    lines, texts = entity.lines[0], entity.texts
    assert [color.g for color in lines.colors] == [0.9, 0.9, 0.5, 0.5, 0.6, 0.6, 0.0, 0.0]
    assert [(p.x, p.y) for p in lines.points[:2]] == [(1.0, 0.0), (19.0, 0.0)]
    assert [(p.x, p.y) for p in lines.points[4:6]] == [(0.0, 1.0), (0.0, 29.0)]
    assert [text.text for text in texts] == ["- 6%", "- 6%", "NE 100%", "- 6%"]
    assert [(t.pose.position.x, t.pose.position.y) for t in texts][2] == (0.0, 30.0)


def test_every_corridor_is_a_strip_of_points_in_the_colour_of_its_probability() -> None:
    views = Views(EPOCH_NS)
    views.of(_sent(BUILDING))
    belief = map_belief(0, [0.8, 0.5, 1.0, 0.0], [[1, 0, 1, 1]], [-2.0])
    cloud = _view(belief, views, "view/chances")
    assert (cloud.frame_id, cloud.timestamp.seconds) == ("building", EPOCH_NS // S + 5)
    assert cloud.pose.orientation.w == 1.0
    kinds = {1: "u1", 7: "<f4"}
    point = np.dtype(
        {
            "names": [f.name for f in cloud.fields],
            "formats": [kinds[f.type] for f in cloud.fields],
            "offsets": [f.offset for f in cloud.fields],
            "itemsize": cloud.point_stride,
        }
    )
    points = np.frombuffer(cloud.data, point).reshape(4, -1)
    assert points["probability"] == pytest.approx(np.tile(belief.corridors[:, None], 32))
    assert points["red"].T.tolist() == [[51, 128, 0, 255]] * 32  # as the names of viewers have it
    assert points["green"][:, 0].tolist() == [204, 128, 255, 0]
    assert points["alpha"][:, 0].tolist() == [199, 153, 229, 76]
    # corridors 0 and 1 lie east, at y = 0 and 30 m; 2 and 3 north, at x = 0 and 20 m
    assert sorted(set(points["y"][0].tolist())) == [-0.25, 0.25]
    assert sorted(set(points["y"][1].tolist())) == [29.75, 30.25]
    assert sorted(set(points["x"][2].tolist())) == [-0.25, 0.25]
    assert (points["x"][0].min(), points["x"][0].max()) == (1.5625, 18.4375)  # 18 m in 16 parts
    assert (points["y"][3].min(), points["y"][3].max()) == (1.875, 28.125)
    assert not points["z"].any()


def test_a_belief_about_another_grid_is_not_drawn() -> None:
    views = Views(EPOCH_NS)
    views.of(_sent(BUILDING))
    belief = map_belief(0, [0.5] * 4, [], [])
    other = m.MapBelief(
        **{f: getattr(belief, f) for f in belief.__struct_fields__} | {"corridors": np.ones(7)}
    )
    assert views.of(_sent(other)) == []


WORDS: list[tuple[m.Message, int, str]] = [
    (
        m.DeadlineMissed(4, "path", 480 * S),
        Log.WARNING,
        "path decision 4 missed its deadline of 480.000 s",
    ),
    (
        entry(4, "path", 300, 480, 500, idle_s=20, cause="overrun"),
        Log.WARNING,
        "path decision 4 came 20.000 s late (overrun), 20.000 s idle; instead: stand",
    ),
    (
        entry(6, "path", 500, 550, None, idle_s=10, cause="message lost"),
        Log.WARNING,
        "path decision 6 never came (message lost), 10.000 s idle; instead: stand",
    ),
    (
        m.TrueErrand(1, 0, 3, 0, 500 * S, 400.0),
        Log.INFO,
        "errand 1 from 0 to 3 done in 500.0 s; the shortest way takes 400.0 s",
    ),
    (
        m.TrueEncounter(2, True, 0.1, 11.0),
        Log.WARNING,
        "encounter 2: collided with a person, closest 0.10 m, delay 11.0 s",
    ),
    (
        m.TrueEncounter(1, False, 0.8, 4.0),
        Log.INFO,
        "encounter 1: met a person, closest 0.80 m, delay 4.0 s",
    ),
    (
        m.Refused("ledger", "intruder", 9, "unknown source", 1),
        Log.ERROR,
        "refused message 9 of intruder on ledger: unknown source",
    ),
    (m.RunEnded("done"), Log.INFO, "the run ended: done"),
    (m.RunEnded("process down: decider"), Log.ERROR, "the run ended: process down: decider"),
    (
        m.SensingDecision(5, 2, 3, np.array([7, 7, -1]), np.array([0, 0, 7]), np.zeros(3), 2),
        Log.INFO,
        "sensing decision 5, visit 2 after action 3: detector 7 if 0 1; conclude NES if 2",
    ),
    (
        m.ReactionDecision("stop", np.array([-1.0, -2.5]), 0.9, 0, 0.65),
        Log.INFO,
        "reaction: stop; expected utilities -1, -2.5",
    ),
]


@pytest.mark.parametrize(("message", "level", "words"), WORDS)
def test_the_log_says_what_happened(message: m.Message, level: int, words: str) -> None:
    assert _words(message) == (level, words)


def test_a_path_decision_is_said_way_by_way() -> None:
    direction = np.array([0, 1, 2, 2] + [0] * 12, dtype=np.uint8)
    numbers = np.zeros(16)
    decision = m.PathDecision(7, 3, direction, numbers, numbers, direction, 20)
    level, words = _words(decision)
    assert (level, words.partition(":")[0]) == (Log.INFO, "path decision 7, visit 3")
    assert "; N if N; E if E NE" in words
    assert words.count(" if ") == 3


def test_a_lost_robot_says_where_it_may_be_and_why_it_looks() -> None:
    ahead, none = np.full((2, 16), 1 / 16), np.zeros(16)
    said = m.Registrations(
        4, 2, np.array([5, 3]), np.array([0.25, 0.75]), ahead, none[None], none[None],
        np.zeros(1, np.int64), np.zeros((1, 4), np.uint8), np.ones(1), none[:1],
    )  # fmt: skip
    assert _words(said) == (Log.INFO, "visit 4 may be at intersection 3 (0.750), 5 (0.250)")
    now_s, look_s, looks = np.full(16, np.inf), np.full(16, np.inf), np.zeros(16, np.uint8)
    acts_at, looks_at = np.full(16, -1), np.full(16, -1)
    now_s[[3, 5]], acts_at[[3, 5]] = (1868.4, 660.0), (11, 9)
    look_s[3], looks[3], looks_at[3] = 1705.2, 1, 4
    decision = m.RegistrationDecision(7, 3, now_s, look_s, looks, acts_at, looks_at)
    assert _words(decision) == (
        Log.INFO,
        "path decision 7, visit 3: NE: as if at 11 looks at 4 first, 1,705 s against 1,868 s at "
        "once; NS: goes as if at 9, 660 s; after a look: nowhere to look",
    )
    assert _words(m.AtErrand(2, 24, here=False))[1].startswith("nobody expects the robot here")
    assert _words(m.AtErrand(3, 24, here=True))[1].endswith("this is intersection 24")


def test_a_decision_in_time_is_no_news() -> None:
    assert Views(EPOCH_NS).of(_sent(entry(1, "path", 0, 240, 50))) == []


def test_every_topic_in_words_has_words(run: list[Sent]) -> None:
    views = Views(EPOCH_NS)
    said = {sent.topic: views.of(sent) for sent in run if sent.topic in IN_WORDS}
    assert all(found[0][0] == "view/log" for found in said.values())
    silent = [sent.topic for sent in run if sent.topic not in IN_WORDS]
    assert not any(t == "view/log" for s in run if s.topic in silent for t, _ in views.of(s))


def test_views_repeat_bit_for_bit_and_our_reader_passes_them_by(
    run: list[Sent], make_log: MakeLog
) -> None:
    one, other = Views(EPOCH_NS), Views(EPOCH_NS)
    assert [one.of(sent) for sent in run] == [other.of(sent) for sent in run]
    reader = read_run(make_log(run))
    assert [sent.id for sent in reader] == [sent.id for sent in run]
    assert sum(reader.counts.values()) == len(run)
