"""What a run's log says: the ledger, the errands, the belief, the loads, in one pass.

A log that is not whole gets no verdict: it is *inconclusive*, with the reasons.
"""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from bus import messages as m
from bus.grid import Grid
from bus.wire import Sent
from logs.belief import FinalBelief, final_belief, fits
from logs.decisions import NS_PER_S, Decisions, LateDecision, late_decision, on_time, summarise
from logs.loads import Load, Loads
from logs.reader import RunReader, read_run

INCONCLUSIVE, LATE, IN_TIME = "inconclusive", "late", "in time"
PROCESS_LOST = ("process down", "process frozen")


@dataclass(frozen=True)
class Errand:
    """An errand that was done; ``ratio`` is its time over that of the shortest way.

    ``start`` and ``goal`` are intersections (x, y), ``ratio`` None for a way of no length.
    """

    errand: int
    start: tuple[int, int]
    goal: tuple[int, int]
    time_s: float
    shortest_s: float
    ratio: float | None


@dataclass(frozen=True)
class Errands:
    """All errands that were done, and their times together."""

    number: int
    time_s: float
    shortest_s: float
    ratio: float | None
    each: tuple[Errand, ...]


@dataclass(frozen=True)
class Sensing:
    """How many sensing actions gave a reading, over how many junctions were classified."""

    readings: int
    visits: int
    per_visit: float | None


@dataclass(frozen=True)
class Encounters:
    """Meetings with people; ``closest_m`` is None where there were none."""

    number: int
    collisions: int
    closest_m: float | None
    delay_s: float


@dataclass(frozen=True)
class RefusedMessages:
    """Messages of one source on one topic that were not let in for one reason."""

    topic: str
    source: str
    reason: str
    number: int


@dataclass(frozen=True)
class Analysis:
    """All that one log says. ``reasons`` is why it gets no verdict; empty for a whole log."""

    path: str
    metadata: dict[str, str]
    verdict: str
    reasons: tuple[str, ...]
    ended: str
    duration_s: float
    decisions: tuple[Decisions, ...]
    late: tuple[LateDecision, ...]
    errands: Errands
    sensing: Sensing
    belief: FinalBelief | None
    encounters: Encounters
    refused: tuple[RefusedMessages, ...]
    loads: tuple[Load, ...]
    topics: dict[str, int]

    @property
    def inconclusive(self) -> bool:
        """Whether no verdict is honest."""
        return self.verdict == INCONCLUSIVE


HEARD = (
    "asked/sensing",
    "asked/path",
    "asked/reaction",
    "ledger",
    "likelihood/junction",
    "belief/map",
    "clock/span",
    "health/refused",
    "run/ended",
    "truth/building",
    "truth/errand",
    "truth/encounter",
)
"""What an analysis decodes; the other topics it only counts."""


class Tally:
    """What was heard of a log so far, to be summed up at its end."""

    def __init__(self) -> None:
        self.ledger: list[m.LedgerEntry] = []
        self._asked: dict[tuple[str, int], None] = {}
        self._errands: list[m.TrueErrand] = []
        self._encounters: list[m.TrueEncounter] = []
        self._finished: dict[int, None] = {}
        self._refused: dict[tuple[str, str, str], int] = {}
        self.loads = Loads()
        self._building: m.TrueBuilding | None = None
        self._belief: tuple[m.MapBelief, int] | None = None
        self._ended: tuple[str, int] | None = None

    def hear(self, sent: Sent) -> None:
        """Take one message into account."""
        match sent.message:
            case m.Span() as span:
                took_ns = span.end_ns - span.start_ns
                self.loads.add(span.process, span.topic, took_ns, span.cells, None)
            case m.MapBelief() as belief:
                self._belief = (belief, sent.said_ns)
            case m.JunctionLikelihood(finished=True) as likelihood:
                self._finished[likelihood.visit] = None
            case m.RunEnded() as ended:
                self._ended = (ended.reason, sent.said_ns)
            case m.Refused() as refused:
                key = (refused.topic, refused.source, refused.reason)
                self._refused[key] = self._refused.get(key, 0) + 1
            case _:
                self._hear_world(sent)

    def _hear_world(self, sent: Sent) -> None:
        match sent.message:
            case m.LedgerEntry() as entry:
                self.ledger.append(entry)
            case m.AskedSensing() | m.AskedPath() | m.AskedReaction() as asked:
                self._asked[sent.topic.removeprefix("asked/"), asked.decision] = None
            case m.TrueBuilding() as building:
                self._building = building
            case m.TrueErrand() as errand:
                self._errands.append(errand)
            case m.TrueEncounter() as encounter:
                self._encounters.append(encounter)

    def analysis(self, reader: RunReader) -> Analysis:
        """Sum up; the reader must have come to its end."""
        duration_ns = self._ended[1] if self._ended else reader.last_said_ns
        late = tuple(late_decision(entry) for entry in self.ledger if not on_time(entry))
        reasons = tuple(self._reasons(reader))
        return Analysis(
            path=str(reader.path),
            metadata=reader.metadata,
            verdict=INCONCLUSIVE if reasons else LATE if late else IN_TIME,
            reasons=reasons,
            ended=self._ended[0] if self._ended else "",
            duration_s=duration_ns / NS_PER_S,
            decisions=summarise(self.ledger, self._asked),
            late=late,
            errands=_errands(tuple(self._errand(errand) for errand in self._errands)),
            sensing=_sensing(reader.counts["reading/feature"], len(self._finished)),
            belief=self._final_belief(),
            encounters=_encounters(self._encounters),
            refused=tuple(RefusedMessages(*key, number) for key, number in self._refused.items()),
            loads=self.loads.loads(duration_ns),
            topics=dict(reader.counts),
        )

    def _reasons(self, reader: RunReader) -> list[str]:
        reasons: list[str] = []
        if reader.truncated:
            reasons.append(f"the log is truncated: {reader.problem}")
        if self._ended is None:
            reasons.append("the log does not say why the run ended")
        elif self._ended[0].startswith(PROCESS_LOST):
            reasons.append(f"the run ended because of a {self._ended[0]}")
        reasons += [
            f"{number} of the messages of {source} are not in the log"
            for source, number in reader.missing.items()
        ]
        if not self.ledger:
            reasons.append("the ledger is empty: no decision was settled")
        if self._belief and self._building and not fits(self._belief[0], self._building):
            reasons.append(
                f"belief/map is about {len(self._belief[0].corridors)} corridors, "
                f"truth/building has {len(self._building.corridors)}"
            )
        return reasons

    def _final_belief(self) -> FinalBelief | None:
        if self._belief is None or self._building is None:
            return None
        belief, said_ns = self._belief
        if not fits(belief, self._building):
            return None
        return final_belief(belief, self._building, said_ns / NS_PER_S)

    def _errand(self, errand: m.TrueErrand) -> Errand:
        time_s = (errand.ended_ns - errand.began_ns) / NS_PER_S
        shortest_s = errand.shortest_s
        start, goal = self._place(errand.start), self._place(errand.goal)
        return Errand(errand.errand, start, goal, time_s, shortest_s, _ratio(time_s, shortest_s))

    def _place(self, intersection: int) -> tuple[int, int]:
        if self._building is None:
            return (intersection, 0)
        return grid_of(self._building).place(intersection)


def grid_of(building: m.TrueBuilding) -> Grid:
    """The grid that a building stands on."""
    return Grid(len(building.columns_m), len(building.rows_m))


def _sensing(readings: int, visits: int) -> Sensing:
    return Sensing(readings, visits, _ratio(readings, visits))


def _errands(each: tuple[Errand, ...]) -> Errands:
    time_s = sum(errand.time_s for errand in each)
    shortest_s = sum(errand.shortest_s for errand in each)
    return Errands(len(each), time_s, shortest_s, _ratio(time_s, shortest_s), each)


def _ratio(part: float, whole: float) -> float | None:
    return part / whole if whole > 0 else None


def _encounters(encounters: list[m.TrueEncounter]) -> Encounters:
    return Encounters(
        number=len(encounters),
        collisions=sum(e.collided for e in encounters),
        closest_m=min((e.closest_m for e in encounters), default=None),
        delay_s=sum(e.delay_s for e in encounters),
    )


def analyse(path: str | Path) -> Analysis:
    """Analyse a log in one pass. Raises LogReadError if it is not the log of a run."""
    tally = Tally()
    with read_run(path, HEARD) as reader:
        for sent in reader:
            tally.hear(sent)
    return tally.analysis(reader)


def to_json(analysis: Analysis) -> dict[str, Any]:
    """A plain dict of an analysis: its fields in their order, times in seconds.

    It is strict JSON: a number that is not finite becomes None.
    """
    return finite(asdict(analysis))


def finite(plain: dict[str, Any]) -> dict[str, Any]:
    """The same as JSON has it, with None for every number that is not finite."""
    text = json.dumps(plain)
    strict: dict[str, Any] = json.loads(text, parse_constant=lambda _: None)
    return strict
