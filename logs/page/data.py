"""The data of a page as plain JSON, thinned to what a screen can show.

Times are seconds, positions metres, angles degrees; lists rather than objects where there are
many of them. The script of the page says the same of each where it reads it.
"""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from typing import Any

from bus.grid import Grid
from bus.messages import LedgerEntry, TrueBuilding
from logs.chains import DecisionChain, Hop
from logs.decisions import NEVER, NS_PER_S, cause_of, on_time
from logs.page.record import Record
from logs.page.story import outcome
from logs.page.thin import evenly

MOST_PINGS = 4000
MOST_KNOTS = 15_000
MOST_LATE, MOST_IN_TIME = 1500, 1500
MOST_MARGINALS = 150_000
"""Corridors times beliefs."""

MOST_HOPS = 16
"""Of one decision's chain, those nearest to it."""

MOST_MEETINGS, MOST_SIGHTINGS, MOST_GOALS = 500, 40, 3000


def page_data(
    record: Record,
    ledger: Sequence[LedgerEntry],
    chains: Sequence[DecisionChain],
    duration_s: float,
) -> dict[str, Any]:
    """All that the page's script draws, and in ``notes`` what was left out of it."""
    shown = _shown(ledger)
    by_decision = {(one.kind, one.decision): one for one in chains}
    return {
        "duration": duration_s,
        "notes": notes(record, ledger),
        "building": None if record.building is None else _building(record.building),
        "trail": _trail(record),
        "pings": [
            [_s(ping.at_ns), *ping.ranges_cm.tolist()] for ping in evenly(record.pings, MOST_PINGS)
        ],
        "beliefs": _beliefs(record),
        "goals": [[_s(at_ns), goal] for at_ns, goal in evenly(record.goals, MOST_GOALS)],
        "places": [
            [_s(at_ns), *([place, round(p, 4)] for place, p in rows)]
            for at_ns, rows in evenly(record.whereabouts.each, MOST_GOALS)
        ],
        "meetings": _meetings(record),
        "decisions": [
            {
                **_decision(record, entry),
                **_chain(by_decision.get((entry.kind, entry.decision))),
            }
            for entry in shown
        ],
        "spans": {
            name: [
                [_s(of.start_ns), _s(of.end_ns), of.handlers, of.cells, _s(of.busy_ns)]
                for of in row
            ]
            for name, row in record.spans.rows().items()
        },
        "errands": [
            [of.errand, _s(of.began_ns), _s(of.ended_ns), round(of.shortest_s, 3)]
            for of in evenly(record.errands, MOST_GOALS)
        ],
    }


def notes(record: Record, ledger: Sequence[LedgerEntry]) -> list[str]:
    """What the page leaves out, one sentence each; empty if nothing."""
    said: list[str] = []
    for name, number, most in (
        ("pings of the ring", len(record.pings), MOST_PINGS),
        ("points of the robot's way", len(record.trail.knots), MOST_KNOTS),
        ("beliefs", len(record.beliefs), _most_beliefs(record)),
    ):
        if number > most:
            said.append(f"{most:,} of {number:,} {name} are shown.")
    if len(_shown(ledger)) < len(ledger):
        said.append(
            f"{len(_shown(ledger)):,} of {len(ledger):,} decisions are shown one by one: the "
            f"late ones up to the {MOST_LATE:,} worst, and an even choice of those in time. The "
            "first table and the histograms count all."
        )
    if record.spans.coarsest_s > 0:
        said.append(f"Work with pauses below {record.spans.coarsest_s:.3g} s is drawn as one bar.")
    return said


def as_script(data: dict[str, Any]) -> str:
    """JSON that may stand inside of a script element: no ``<`` can end it.

    A number that is not finite becomes null: browsers refuse the names that Python has for them.
    """
    plain = json.loads(json.dumps(data), parse_constant=lambda _: None)
    text = json.dumps(plain, separators=(",", ":"), allow_nan=False)
    return text.replace("<", "\\u003c")


def _s(ns: int) -> float:
    return round(ns / NS_PER_S, 4)


def _building(building: TrueBuilding) -> dict[str, Any]:
    grid = Grid(len(building.columns_m), len(building.rows_m))
    return {
        "columns": building.columns_m.tolist(),
        "rows": building.rows_m.tolist(),
        "width": building.corridor_width_m,
        "exists": building.corridors.tolist(),
        "ends": [list(grid.ends(corridor)) for corridor in range(grid.corridors)],
    }


def _trail(record: Record) -> list[list[float]]:
    return [
        [
            _s(knot.at_ns),
            round(knot.x_m, 2),
            round(knot.y_m, 2),
            round(math.degrees(knot.heading_rad), 1),
        ]
        for knot in evenly(record.trail.knots, MOST_KNOTS)
    ]


def _most_beliefs(record: Record) -> int:
    corridors = len(record.beliefs[0].corridors) if record.beliefs else 1
    return max(2, MOST_MARGINALS // max(1, corridors))


def _beliefs(record: Record) -> list[list[float]]:
    return [
        [_s(belief.at_ns), *(round(p, 4) for p in belief.corridors.tolist())]
        for belief in evenly(record.beliefs, _most_beliefs(record))
    ]


def _meetings(record: Record) -> list[dict[str, Any]]:
    return [
        {
            "encounter": of.encounter,
            "from": _s(of.from_ns),
            "over": None if of.over_ns is None else _s(of.over_ns),
            "collided": of.collided,
            "closest": round(of.closest_m, 2),
            "seen": [
                [_s(at_ns), round(range_m, 2), transducer]
                for at_ns, range_m, transducer in evenly(of.seen, MOST_SIGHTINGS)
            ],
        }
        for of in evenly(record.people.meetings, MOST_MEETINGS)
    ]


def _shown(ledger: Sequence[LedgerEntry]) -> list[LedgerEntry]:
    """The worst of the late decisions and an even choice of the others, in their order."""
    late = sorted((entry for entry in ledger if not on_time(entry)), key=_worst_first)[:MOST_LATE]
    good = evenly([entry for entry in ledger if on_time(entry)], MOST_IN_TIME)
    return sorted((*late, *good), key=lambda entry: (entry.asked_ns, entry.decision))


def _worst_first(entry: LedgerEntry) -> tuple[bool, int]:
    return entry.decided_ns != NEVER, entry.slack_ns


def _decision(record: Record, entry: LedgerEntry) -> dict[str, Any]:
    told = record.story.tell(entry)
    came = entry.decided_ns != NEVER
    return {
        "id": entry.decision,
        "kind": entry.kind,
        "visit": entry.visit,
        "asked": _s(entry.asked_ns),
        "until": _s(entry.until_ns),
        "decided": _s(entry.decided_ns) if came else None,
        "slack": _s(entry.slack_ns) if came else None,
        "idle": _s(entry.idle_ns),
        "cells": entry.cells,
        "size": entry.size,
        "late": not on_time(entry),
        "cause": "" if on_time(entry) else cause_of(entry),
        "outcome": outcome(entry),
        "words": told.words,
        "at": _s(told.at_ns),
    }


def _chain(one: DecisionChain | None) -> dict[str, Any]:
    """What led to a decision, last first; ``age`` is of the percepts that it was made from."""
    if one is None:
        return {"chain": [], "whole": True, "age": None}
    hops, age = one.chain.hops[::-1], one.chain.age
    return {
        "chain": [_hop(hop) for hop in hops[:MOST_HOPS]],
        "whole": one.chain.whole and len(hops) <= MOST_HOPS,
        "age": None if age is None else [age.percepts, _s(age.newest_ns), _s(age.oldest_ns)],
    }


def _hop(hop: Hop) -> list[Any]:
    parts_ns = (hop.transport_ns, hop.queueing_ns, hop.computing_ns)
    parts = (round(ns / NS_PER_S, 6) for ns in parts_ns)
    return [hop.topic, hop.source, hop.sequence, hop.process, _s(hop.said_ns), *parts]
