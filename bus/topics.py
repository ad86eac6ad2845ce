"""The one table of topics: what is said, by whom, to whom.

The bus, the recorder's channels and the tests are all made from it. Every topic is also
heard by the recorder; ``truth/*`` by nobody else.
"""

from __future__ import annotations

from dataclasses import dataclass

from bus import messages as m

WORLD, RECORDER, CLOCK, BUS = "world", "recorder", "clock", "bus"
SENSOR, DETECTORS, CLASSIFIER = "sensor", "detectors", "classifier"
GEOGRAPHER, DECIDER, REACTOR = "geographer", "decider", "reactor"

MODULES = (REACTOR, SENSOR, DETECTORS, CLASSIFIER, GEOGRAPHER, DECIDER)
"""The modules in the order of their priority: the first runs first where they must queue."""

PRIORITY = {WORLD: 0, **{name: i + 1 for i, name in enumerate(MODULES)}}


@dataclass(frozen=True)
class Topic:
    """One row: the message type, who says it, who hears it, how often it is expected."""

    name: str
    type: type[m.Message]
    publisher: str
    subscribers: tuple[str, ...] = ()
    expected: str = "when it happens"
    truth: bool = False


_TABLE = (
    Topic("percept/odometry", m.Odometry, WORLD, (SENSOR,), "every 5 pings, every on attention"),
    Topic("percept/sonar", m.Sonar, WORLD, (SENSOR,), "2 s driving, 0.25 s on attention"),
    Topic("percept/departure", m.Departure, WORLD, (GEOGRAPHER, CLASSIFIER, REACTOR), "4 min"),
    Topic("percept/arrival", m.Arrival, WORLD, (GEOGRAPHER, CLASSIFIER, DETECTORS), "4 min"),
    Topic("percept/blocked", m.Blocked, WORLD, (GEOGRAPHER,), "after a wrong turn"),
    Topic("percept/action", m.ActionEnded, WORLD, (DETECTORS,), "30-60 s at an LDP"),
    Topic("belief/ranges", m.Ranges, SENSOR, (REACTOR,), "every ping while driving"),
    Topic("belief/scan", m.Scan, SENSOR, (DETECTORS,), "every ping of a sensing action"),
    Topic("belief/pose", m.PoseBelief, SENSOR, (GEOGRAPHER,), "every 25 pings"),
    Topic("reading/feature", m.Reading, DETECTORS, (CLASSIFIER, WORLD), "30-60 s at an LDP"),
    Topic("prior/junction", m.JunctionPrior, GEOGRAPHER, (CLASSIFIER,), "each corridor"),
    Topic("stakes/junction", m.JunctionStakes, DECIDER, (CLASSIFIER,), "each corridor"),
    Topic("likelihood/junction", m.JunctionLikelihood, CLASSIFIER, (GEOGRAPHER,), "each reading"),
    Topic("belief/map", m.MapBelief, GEOGRAPHER, (DECIDER,), "each corridor"),
    Topic("asked/sensing", m.AskedSensing, WORLD, (CLASSIFIER,), "each action, each corridor"),
    Topic("asked/path", m.AskedPath, WORLD, (DECIDER,), "each corridor"),
    Topic("asked/reaction", m.AskedReaction, WORLD, (), "each encounter"),
    Topic("decision/sensing", m.SensingDecision, CLASSIFIER, (DETECTORS, WORLD), "each action"),
    Topic("decision/path", m.PathDecision, DECIDER, (WORLD,), "each corridor"),
    Topic("decision/reaction", m.ReactionDecision, REACTOR, (WORLD,), "each change of mind"),
    Topic("command/motion", m.Motion, DETECTORS, (WORLD,), "each action"),
    Topic("command/attention", m.Attention, REACTOR, (WORLD,), "each encounter"),
    Topic("deadline/missed", m.DeadlineMissed, WORLD, (), "never"),
    Topic("ledger", m.LedgerEntry, WORLD, (), "each decision"),
    Topic("clock/span", m.Span, CLOCK, (), "each handler"),
    # From a source of its own: a refusal must not change the numbers of anything else.
    Topic("wall/span", m.WallSpan, CLOCK, (), "each handler, in RUN.wall.mcap alone"),
    Topic("health/state", m.ProcessState, CLOCK, (), "at the beginning, at the end"),
    Topic("output", m.Output, CLOCK, (), "whenever a handler prints"),
    Topic("health/refused", m.Refused, BUS, (), "never"),
    Topic("run/ended", m.RunEnded, WORLD, (), "once"),
    Topic("truth/building", m.TrueBuilding, WORLD, (), "once", truth=True),
    Topic("truth/pose", m.TruePose, WORLD, (), "each LDP", truth=True),
    Topic("truth/errand", m.TrueErrand, WORLD, (), "each errand", truth=True),
    Topic("truth/encounter", m.TrueEncounter, WORLD, (), "each encounter", truth=True),
    # Of a robot that does not know where it is, and how much time it has (paper, section 2).
    Topic("percept/errand", m.AtErrand, WORLD, (GEOGRAPHER,), "each LDP, if it is lost"),
    Topic("asked/errand", m.AskedErrand, WORLD, (DECIDER,), "each corridor, if it is due"),
    Topic("belief/registrations", m.Registrations, GEOGRAPHER, (DECIDER,), "while it is lost"),
    Topic("decision/registration", m.RegistrationDecision, DECIDER, (), "while it is lost"),
)

TOPICS: dict[str, Topic] = {topic.name: topic for topic in _TABLE}
TOPIC_OF: dict[type[m.Message], Topic] = {topic.type: topic for topic in _TABLE}


def heard_by(process: str) -> tuple[Topic, ...]:
    """The topics that a process listens to, in the order of the table."""
    if process == RECORDER:
        return _TABLE
    return tuple(topic for topic in _TABLE if process in topic.subscribers)
