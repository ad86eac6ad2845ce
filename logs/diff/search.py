"""The search for the first message that differs: both logs in one pass, in step.

A log's order is a function of what was said, so two runs that say the same have the same
messages at the same places, and the first place that differs is where they part: all that was
said before is equal. The clock alone numbers what it notes down when a handler begins and says
it when that ends; a number of its that differs tells of a handler that has yet to end, hence
these numbers are passed over. What is kept is a stretch on either side of that place, however
long the logs are.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import chain, islice
from pathlib import Path

from bus.topics import CLOCK, TOPICS
from logs.diff.events import Event, event_of
from logs.reader import LogReadError, RawSent, RunReader, read_run
from logs.schema import SchemaError

STRETCH = 20_000
"""So many messages are kept before and after the first difference: an hour of a run, say."""


@dataclass(frozen=True)
class Parting:
    """What two runs say around the place where they part.

    ``common`` is what both said last; ``base`` and ``new`` is what each says from there on.
    One of them is empty where that log ends there.
    """

    common: tuple[Event, ...]
    base: tuple[Event, ...]
    new: tuple[Event, ...]


@dataclass(frozen=True)
class Searched:
    """How a search ended: ``parting`` is None where no difference was found.

    ``equal`` messages came before it; ``renumbered`` is the first, in base, that has another
    number of the clock; ``incomplete`` says what of the logs is not there, as far as they were
    read.
    """

    parting: Parting | None
    equal: int
    renumbered: Event | None
    incomplete: tuple[str, ...]


def search(base: Path, new: Path) -> Searched:
    """Find where two logs part. Raises LogReadError where a file is not the log of a run.

    Where one log is cut off and all that is in it is equal, no difference was found.
    """
    with read_run(base) as of_base, read_run(new) as of_new:
        try:
            return _search(of_base, of_new)
        except SchemaError as error:
            raise LogReadError(f"{base}, {new}: {error}") from error


def _search(base: RunReader, new: RunReader) -> Searched:
    before: deque[RawSent] = deque(maxlen=STRETCH)
    in_base, in_new = base.raw(), new.raw()
    equal = 0
    renumbered: Event | None = None
    while True:
        first_base, first_new = next(in_base, None), next(in_new, None)
        if first_base is None or first_new is None:
            break
        if first_base != first_new:
            if not _equal_but_numbers(first_base, first_new):
                break
            renumbered = renumbered or event_of(first_base)
        before.append(first_base)
        equal += 1
    parting = None
    both_end = first_base is None and first_new is None
    if not both_end and not _cut_there(base, first_base, new, first_new):
        parting = Parting(
            tuple(map(event_of, before)),
            _from(first_base, in_base),
            _from(first_new, in_new),
        )
    return Searched(parting, equal, renumbered, (*incomplete(base), *incomplete(new)))


def _equal_but_numbers(base: RawSent, new: RawSent) -> bool:
    """Whether both are the same words of the clock under other numbers."""
    if base[:2] != new[:2] or TOPICS[base[0]].publisher != CLOCK:
        return False
    one, two = event_of(base).record, event_of(new).record
    for record in (one, two):
        record.sequence = record.previous = 0
    return bool(one == two)


def _cut_there(
    base: RunReader, first_base: RawSent | None, new: RunReader, first_new: RawSent | None
) -> bool:
    """Whether a log that was cut off ends where the two would part."""
    return (first_base is None and base.truncated) or (first_new is None and new.truncated)


def _from(first: RawSent | None, rest: Iterator[RawSent]) -> tuple[Event, ...]:
    if first is None:
        return ()
    return tuple(map(event_of, islice(chain((first,), rest), STRETCH)))


def incomplete(reader: RunReader) -> list[str]:
    """What of a log is not there, as far as it was read."""
    reasons = [f"{reader.path} is truncated: {reader.problem}"] if reader.truncated else []
    return reasons + [
        f"{reader.path}: {number} of the messages of {source} are not there"
        for source, number in reader.missing.items()
    ]
