"""A test's baseline: what its runs came to, committed beside it."""

from __future__ import annotations

import difflib
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path

from logs.regress.baseline import BaselineError, baseline_text, read_baseline, write_baseline
from logs.regress.matching import MismatchError
from logs.regress.regression import GOOD, regress
from logs.regress.report import text_lines
from scenarios.testing.runs import Run

UPDATE = "--waywiser-update"
SHOWN = 40
"""Lines of the difference that a message shows."""


@dataclass(frozen=True)
class Baseline:
    """Holds runs against a file; ``update`` writes it instead and tells ``updated``."""

    folder: Path
    name: str
    update: bool
    updated: Callable[[Path], None]

    def holds(self, runs: Iterable[Run], name: str | None = None) -> bool:
        """The runs are those of the baseline ``name`` (default: the test's own name).

        Simulated time and work are compared exactly. Raises AssertionError with the cause and
        the lines that differ.
        """
        __tracebackhide__ = True
        path = self.folder / f"{name or self.name}.jsonl"
        summaries = [run.summary for run in runs]
        text = baseline_text(summaries)
        if self.update:
            if not path.is_file() or path.read_text(encoding="utf-8") != text:
                write_baseline(path, summaries)
                self.updated(path)
            return True
        try:
            found = regress(read_baseline(path), summaries)
        except (BaselineError, MismatchError) as error:
            raise AssertionError(f"{error}\nwrite it with pytest {UPDATE}") from None
        if found.outcome != GOOD:
            lines = [*text_lines(found), *_difference(path, text)]
            raise AssertionError("\n".join((*lines, f"if it is right so: pytest {UPDATE}")))
        return True


def _difference(path: Path, text: str) -> list[str]:
    was = path.read_text(encoding="utf-8").splitlines()
    lines = list(
        difflib.unified_diff(was, text.splitlines(), str(path), "this run", n=0, lineterm="")
    )
    more = len(lines) - SHOWN
    return [*lines[:SHOWN], *([f"... {more} more lines"] if more > 0 else [])]
