"""What a comparison finds: the first event that differs between two runs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

from logs.diff.contents import FieldDifference

Kind: TypeAlias = Literal["missing", "extra", "content", "time", "order", "cost", "failure"]
"""How an event differs, told from base to new.

==========  ============================================================================
missing     said, or handled, in base only
extra       said, or handled, in new only
content     it says something else
time        the same, but earlier or later, though its handler takes as long
order       the same, but before or after something else: priorities
cost        its handler takes another time or touches another number of cells
failure     its handler raises an exception, in a replay
==========  ============================================================================
"""


@dataclass(frozen=True)
class Heard:
    """A message that went into the first difference, and whether it was so in both runs."""

    topic: str
    source: str
    sequence: int
    said_ns: int
    equal: bool


@dataclass(frozen=True)
class FirstDifference:
    """The first event that differs: ``source`` is the process whose doing it is.

    ``at_ns`` is when it was said in the run that said it first, ``topic`` and ``sequence`` what
    it is there (``clock/span``: the end of a handler that said nothing). ``what`` names the
    cause in one sentence. ``heard`` is what the process had handled in that turn and what else
    the event was made from. ``fields`` is where the contents differ.
    """

    at_ns: int
    source: str
    topic: str
    sequence: int
    kind: Kind
    what: str
    heard: tuple[Heard, ...] = ()
    fields: tuple[FieldDifference, ...] = ()

    @property
    def heard_the_same(self) -> bool:
        """Whether all that it had heard was equal in both runs."""
        return all(one.equal for one in self.heard)
