"""Made-up runs, said message by message, whose numbers are known by construction."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TypeAlias

import numpy as np
import pytest

from bus import messages as m
from bus.topics import TOPIC_OF, WORLD
from bus.wire import Sent
from logs.run_log import RunLog
from scenarios.launch import launch_in_process, prepare

S = 10**9
EPOCH_NS = 1_767_225_600 * S  # 2026-01-01T00:00:00Z

MakeLog: TypeAlias = Callable[[list[Sent]], Path]


class Speaker:
    """Says messages for whoever publishes their topic, numbered as on the bus."""

    def __init__(self) -> None:
        self.said: list[Sent] = []
        self._sequence: dict[str, int] = {}
        self._previous: dict[str, int] = {}

    def say(self, at_s: float, message: m.Message) -> Sent:
        topic = TOPIC_OF[type(message)]
        source = topic.publisher
        sequence = self._sequence.get(source, 0)
        self._sequence[source] = sequence + 1
        previous = self._previous.get(topic.name, -1)
        self._previous[topic.name] = sequence
        parents = ((WORLD, 0),) if sequence else ()
        sent = Sent(topic.name, source, sequence, previous, int(at_s * S), parents, message)
        self.said.append(sent)
        return sent


def entry(
    decision: int,
    kind: str,
    asked_s: float,
    until_s: float,
    decided_s: float | None,
    *,
    idle_s: float = 0.0,
    cause: str = "",
) -> m.LedgerEntry:
    decided_ns = -1 if decided_s is None else int(decided_s * S)
    slack_ns = int(until_s * S) - decided_ns if decided_s is not None else -1
    return m.LedgerEntry(
        decision=decision,
        kind=kind,
        visit=decision // 2,
        asked_ns=int(asked_s * S),
        until_ns=int(until_s * S),
        decided_ns=decided_ns,
        slack_ns=slack_ns,
        cells=1000 * decision,
        size=4,
        idle_ns=int(idle_s * S),
        instead="stand" if cause else "",
        cause=cause,
    )


def map_belief(
    visit: int, corridors: list[float], maps: list[list[int]], log_probability: list[float]
) -> m.MapBelief:
    """A belief on the 2x2 grid: four intersections, four corridors."""
    return m.MapBelief(
        visit=visit,
        x=0,
        y=0,
        heading=1,
        junctions=np.full((2, 2, 16), 1 / 16),
        corridors=np.array(corridors),
        drive_s=np.full(4, 240.0),
        log_evidence=-1.5,
        entropy=0.75 / (visit + 1),
        maps=np.array(maps, dtype=np.uint8).reshape(len(maps), 4),
        weights=np.full(len(maps), 1 / max(len(maps), 1)),
        log_probability=np.array(log_probability),
    )


BUILDING = m.TrueBuilding(
    columns_m=np.array([0.0, 20.0]),
    rows_m=np.array([0.0, 30.0]),
    corridor_width_m=2.0,
    corridors=np.array([1, 0, 1, 1], dtype=np.uint8),  # all but the northern one
    start=0,
)


def may_be_at(visit: int, places: list[int], weights: list[float]) -> m.Registrations:
    """Where a robot may be that has lost its place in the building of these tests."""
    n, nothing = len(places), np.zeros((len(places), 4))
    return m.Registrations(
        visit, 2, np.array(places), np.array(weights), np.full((n, 16), 1 / 16), nothing, nothing,
        np.arange(n), np.ones((n, 4), np.uint8), np.ones(n), np.zeros(n),
    )  # fmt: skip


def a_run() -> list[Sent]:
    """A short run with one late path decision, one that never came, errands and a meeting."""
    speaker = Speaker()
    say = speaker.say
    say(0, BUILDING)
    say(0, m.TruePose(0.0, 0.0, 1.57, 0))
    say(0, m.AskedPath(1, 1, np.array([3]), np.array([[0, 3]]), np.array([2.0]), 0, 240 * S))
    say(1, map_belief(0, [0.9, 0.5, 0.6, 0.5], [[1, 0, 1, 1], [1, 1, 1, 1]], [-2.0, -1.5]))
    say(2, m.Span("geographer", "likelihood/junction", "classifier", 0, 0, 1 * S, 300))
    say(2, m.Span("decider", "asked/path", "world", 2, 0, 50 * S, 4000))
    say(40, m.AskedSensing(2, 1, 0, 40 * S, 70 * S))
    say(50, entry(1, "path", 0, 240, 50))
    say(60, m.Reading(1, 1, 0, 2, 0.9, 1, 8))
    say(65, m.Reading(1, 2, 1, 3, 0.2, 0, 8))
    say(66, m.JunctionLikelihood(1, np.full(16, 0.5), 1, False))
    say(67, m.JunctionLikelihood(1, np.full(16, 0.5), 2, True))
    say(68, m.JunctionLikelihood(2, np.full(16, 0.5), 0, False))
    say(60, entry(2, "sensing", 40, 70, 60))
    say(240, m.TruePose(0.0, 30.0, 1.57, 2))
    say(250, m.AskedReaction(3, 1, 250 * S, 253 * S))
    say(252, entry(3, "reaction", 250, 253, 252))
    say(255, m.TrueEncounter(1, False, 0.8, 4.0))
    say(300, m.AskedPath(4, 2, np.array([3]), np.zeros((0, 2), int), np.zeros(0), 0, 480 * S))
    say(500, m.DeadlineMissed(4, "path", 480 * S))
    say(500, entry(4, "path", 300, 480, 500, idle_s=20, cause="overrun"))
    say(560, entry(6, "path", 500, 550, None, idle_s=10, cause="message lost"))
    say(570, m.AskedSensing(7, 2, 3, 570 * S, 600 * S))
    say(580, m.TrueErrand(1, 0, 3, 0, 500 * S, 400.0))
    say(590, m.TrueErrand(2, 3, 0, 500 * S, 590 * S, 200.0))
    say(595, m.TrueEncounter(2, True, 0.1, 11.0))
    say(596, m.Refused("ledger", "intruder", 9, "unknown source", 1))
    say(597, m.Span("decider", "belief/map", "geographer", 1, 500 * S, 510 * S, 6000))
    say(598, map_belief(2, [0.999, 0.002, 0.995, 0.4], [[1, 0, 1, 1], [1, 0, 1, 0]], [-0.5, -1.0]))
    say(600, m.RunEnded("done"))
    return speaker.said


@pytest.fixture
def run() -> list[Sent]:
    return a_run()


@pytest.fixture
def make_log(tmp_path: Path) -> MakeLog:
    def make(said: list[Sent]) -> Path:
        path = tmp_path / "RUN.mcap"
        metadata = {"scenario": "two by two", "seed": "7"}
        with RunLog(path, EPOCH_NS, metadata, {"scenario.toml": b"seed = 7\n"}) as log:
            for sent in said:
                log.write(sent)
        return path

    return make


@pytest.fixture
def run_path(make_log: MakeLog, run: list[Sent]) -> Path:
    return make_log(run)


@pytest.fixture(scope="session")
def late_run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The log of a real run in which some sensing decisions come too late."""
    log = tmp_path_factory.mktemp("late") / "late.mcap"
    launch_in_process(
        prepare("aces", ["compute.profile=free", "compute.slower.sensing=45"], 1), log
    )
    return log
