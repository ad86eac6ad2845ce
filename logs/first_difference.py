"""Where two runs part: the first event that differs, and whose doing it is.

The logs of two runs that say the same are the same, message by message, in one order. Hence
the first place at which they differ is where the runs part, and all that was said before it
was said in both: whoever says something else there had heard the same.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from logs.diff.contents import FieldDifference
from logs.diff.found import FirstDifference, Heard, Kind
from logs.diff.naming import name_parting, name_renumbered
from logs.diff.search import search

__all__ = [
    "Comparison",
    "FieldDifference",
    "FirstDifference",
    "Heard",
    "Kind",
    "compare_logs",
    "first_difference",
]


@dataclass(frozen=True)
class Comparison:
    """``first`` is None where no difference was found; ``equal`` messages came before it.

    ``incomplete`` says what of the logs is not there, as far as they were read: where it is
    not empty and nothing differs, no verdict is honest.
    """

    first: FirstDifference | None
    equal: int
    incomplete: tuple[str, ...]


def compare_logs(base: str | Path, new: str | Path) -> Comparison:
    """Compare the messages of two logs, in one pass and bounded memory.

    Raises LogReadError where a file is not the log of a run.
    """
    searched = search(Path(base), Path(new))
    first = None
    if searched.parting is not None:
        first = name_parting(searched.parting)
    elif searched.renumbered is not None:
        first = name_renumbered(searched.renumbered)
    return Comparison(first, searched.equal, searched.incomplete)


def first_difference(base: str | Path, new: str | Path) -> FirstDifference | None:
    """The first event that differs between two runs, or None.

    None also where a log is cut off and all that is in it is equal. Raises LogReadError.
    """
    return compare_logs(base, new).first
