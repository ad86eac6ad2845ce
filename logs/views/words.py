"""A run in words: decisions, deadlines missed, errands, encounters, messages refused."""

from __future__ import annotations

from collections.abc import Iterable

from foxglove_schemas_protobuf.Log_pb2 import Log

from bus import messages as m
from bus.grid import LETTER, type_name
from bus.wire import Sent
from logs.views.lost import at_errand, looks_or_acts, may_be_at
from logs.views.stamps import stamp

_NS_PER_S = 1e9
_NEVER = -1
"""``decided_ns`` of a decision that never came, and the detector that stands for none."""

Line = tuple["Log.Level.ValueType", str]


def log_line(sent: Sent, unix_ns: int) -> Log | None:
    """A message in words, or None for one that is no news."""
    line = _line(sent.message)
    if line is None:
        return None
    level, words = line
    return Log(
        timestamp=stamp(unix_ns), level=level, message=words, name=sent.source, file=sent.topic
    )


def _line(message: m.Message) -> Line | None:
    match message:
        case m.SensingDecision():
            return Log.INFO, _sensing(message)
        case m.PathDecision():
            return Log.INFO, _path(message)
        case m.RegistrationDecision():
            return Log.INFO, looks_or_acts(message)
        case m.Registrations():
            return Log.INFO, may_be_at(message)
        case m.ReactionDecision():
            utilities = ", ".join(f"{u:.4g}" for u in message.expected_utility.tolist())
            return Log.INFO, f"reaction: {message.act}; expected utilities {utilities}"
        case m.DeadlineMissed():
            return (
                Log.WARNING,
                f"{message.kind} decision {message.decision} missed its deadline of "
                f"{message.until_ns / _NS_PER_S:.3f} s",
            )
        case m.LedgerEntry():
            return _late(message)
        case _:
            return _world_line(message)


def _world_line(message: m.Message) -> Line | None:
    match message:
        case m.AtErrand():
            return Log.INFO, at_errand(message)
        case m.TrueErrand():
            time_s = (message.ended_ns - message.began_ns) / _NS_PER_S
            return (
                Log.INFO,
                f"errand {message.errand} from {message.start} to {message.goal} done in "
                f"{time_s:.1f} s; the shortest way takes {message.shortest_s:.1f} s",
            )
        case m.TrueEncounter():
            how = "collided with a person" if message.collided else "met a person"
            return (
                Log.WARNING if message.collided else Log.INFO,
                f"encounter {message.encounter}: {how}, closest {message.closest_m:.2f} m, "
                f"delay {message.delay_s:.1f} s",
            )
        case m.Refused():
            return (
                Log.ERROR,
                f"refused message {message.sequence} of {message.source or 'nobody'} on "
                f"{message.topic}: {message.reason}",
            )
        case m.RunEnded():
            well = message.reason in ("done", "time")
            return Log.INFO if well else Log.ERROR, f"the run ended: {message.reason}"
    return None


def _late(entry: m.LedgerEntry) -> Line | None:
    if entry.decided_ns != _NEVER and entry.slack_ns >= 0:
        return None
    came = entry.decided_ns != _NEVER
    how = f"came {-entry.slack_ns / _NS_PER_S:.3f} s late" if came else "never came"
    instead = f"; instead: {entry.instead}" if entry.instead else ""
    return (
        Log.WARNING,
        f"{entry.kind} decision {entry.decision} {how} ({entry.cause or 'cause unknown'}), "
        f"{entry.idle_ns / _NS_PER_S:.3f} s idle{instead}",
    )


def _sensing(decision: m.SensingDecision) -> str:
    branches = [
        f"conclude {type_name(concluded)}" if detector == _NEVER else f"detector {detector}"
        for detector, concluded in zip(
            decision.next_detector.tolist(), decision.concluded.tolist(), strict=True
        )
    ]
    return (
        f"sensing decision {decision.decision}, visit {decision.visit} after action "
        f"{decision.action}: {_grouped(map(str, range(len(branches))), branches)}"
    )


def _path(decision: m.PathDecision) -> str:
    ways = [LETTER.get(direction, "stay") for direction in decision.direction.tolist()]
    types = (type_name(junction_type) for junction_type in range(len(ways)))
    return f"path decision {decision.decision}, visit {decision.visit}: {_grouped(types, ways)}"


def _grouped(cases: Iterable[str], choices: list[str]) -> str:
    """Each choice once with all the cases it is for: ``N if NE NS; stay if -``."""
    groups: dict[str, list[str]] = {}
    for case, choice in zip(cases, choices, strict=True):
        groups.setdefault(choice, []).append(case)
    return "; ".join(f"{choice} if {' '.join(found)}" for choice, found in groups.items())
