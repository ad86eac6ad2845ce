"""The [recall] table: what a robot that has lost its place knows of the building (section 2).

It is told what it recalls from an earlier day, where it may be and how probable each place is;
never which of them is the true one.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import chain
from typing import Annotated

import msgspec

from bus.facts import MayBeAt, Recall, Recalled
from bus.grid import DIRECTIONS, LETTER, OPPOSITE, Grid
from simworld.settings import Place, check_place

_BITS = {letter: direction for direction, letter in LETTER.items()}

MOST = 6
"""Places where the robot may be; each has a belief of its own."""

SUM_TOLERANCE = 1e-9


class RecallError(ValueError):
    """A robot that cannot know what the scenario says it does: key, found, expected."""


Chance = Annotated[float, msgspec.Meta(gt=0, lt=1)]


class _Table(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A table of a scenario: unknown keys are errors."""


class RecalledSettings(_Table, frozen=True):
    """A junction that is recalled: the directions in which it is ``open``, as letters."""

    at: Place
    open: str
    certain: Chance = 0.95


class MayBeAtSettings(_Table, frozen=True):
    """A junction that may be the first one of the run."""

    at: Place
    probability: Annotated[float, msgspec.Meta(gt=0, le=1)]


class RecallSettings(_Table, frozen=True):
    """All that the robot knows beforehand; its heading is that of ``world.start``."""

    may_be_at: tuple[MayBeAtSettings, ...]
    places: tuple[RecalledSettings, ...] = ()


def recall_of(settings: RecallSettings, grid: Grid, start: int, heading: int) -> Recall:
    """What the robot knows, which truly begins at ``start``.

    Raises RecallError, and BuildingError for a place off the grid.
    """
    for said in chain(_recalled(settings, grid), _may_be(settings, grid, start, heading)):
        raise RecallError(f"recall.{said}")
    return Recall(
        tuple(
            Recalled(grid.intersection(*one.at), type_of(one.open), one.certain)
            for one in settings.places
        ),
        tuple(MayBeAt(grid.intersection(*one.at), one.probability) for one in settings.may_be_at),
    )


def likeliest(recall: Recall) -> int:
    """The intersection where the robot most probably is; the first of equals."""
    return max(recall.may_be_at, key=lambda one: one.probability).place


def type_of(letters: str) -> int:
    """The junction type that is open in these directions, each given once."""
    return sum(_BITS[letter] for letter in letters)


def _recalled(settings: RecallSettings, grid: Grid) -> Iterator[str]:
    yield from _doubles("places", [one.at for one in settings.places], grid)
    for k, one in enumerate(settings.places):
        if not one.open or sorted(one.open) != sorted({*one.open} & {*_BITS}):
            yield f"places[{k}].open: found {one.open!r}, expected letters of NESW, each once"
        off = [d for d in DIRECTIONS if type_of(one.open) & d and grid.corridor(*one.at, d) < 0]
        if off:
            yield (
                f"places[{k}].open: found {one.open!r}, expected no {LETTER[off[0]]}, which leads "
                f"off the grid at {list(one.at)}"
            )


def _may_be(settings: RecallSettings, grid: Grid, start: int, heading: int) -> Iterator[str]:
    places = [one.at for one in settings.may_be_at]
    if not 1 <= len(places) <= MOST:
        yield f"may_be_at: found {len(places)} places, expected 1 to {MOST}"
    yield from _doubles("may_be_at", places, grid)
    for k, place in enumerate(places):
        if grid.corridor(*place, OPPOSITE[heading]) < 0:
            yield (
                f"may_be_at[{k}].at: found {list(place)}, where nobody can come heading "
                f"{LETTER[heading]}, expected a place with a corridor of the grid behind it"
            )
    total = math.fsum(one.probability for one in settings.may_be_at)
    if abs(total - 1.0) > SUM_TOLERANCE:
        yield f"may_be_at: found probabilities that sum to {total:.9g}, expected 1"
    if start not in [grid.intersection(*place) for place in places]:
        yield (
            f"may_be_at: found no {list(grid.place(start))}, expected it among them, for there "
            f"the robot of world.start is"
        )


def _doubles(key: str, places: list[Place], grid: Grid) -> Iterator[str]:
    for k, place in enumerate(places):
        check_place(grid, place, f"recall.{key}[{k}].at")
        if place in places[:k]:
            yield f"{key}[{k}].at: found {list(place)} again, expected each place once"
