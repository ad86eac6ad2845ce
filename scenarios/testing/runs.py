"""Finished runs of a scenario, as tests look at them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from bus.messages import LedgerEntry, MapBelief
from logs.chains import DecisionChain
from logs.decisions import KINDS
from logs.reader import read_run
from logs.regress.summary import Summary, summarise
from logs.study import Study, study
from scenarios.in_process import run_in_process
from scenarios.launch import prepare
from scenarios.testing.deadlines import Deadlines, Settled


@dataclass(frozen=True)
class Wanted:
    """One run that a test asks for; ``seed`` None is the scenario's own."""

    scenario: str
    seed: int | None
    changes: tuple[str, ...]


class Run:
    """One finished run. What its log says is read when it is asked for, and kept."""

    def __init__(self, seed: int, ended: str, log: Path) -> None:
        self.seed = seed
        self.ended = ended
        self.log = log

    @cached_property
    def study(self) -> Study:
        """All that the log says."""
        return study(self.log)

    @cached_property
    def summary(self) -> Summary:
        """What a baseline keeps of it."""
        return summarise(self.log)

    @property
    def ledger(self) -> tuple[LedgerEntry, ...]:
        """What became of each decision, in the order in which they were settled."""
        return self.study.ledger

    @property
    def chains(self) -> tuple[DecisionChain, ...]:
        """What led to each decision that came, the one with the least slack first."""
        return self.study.chains

    @cached_property
    def beliefs(self) -> tuple[MapBelief, ...]:
        """What the geographer believed of the map, in the order of time."""
        with read_run(self.log, ("belief/map",)) as reader:
            return tuple(s.message for s in reader if isinstance(s.message, MapBelief))

    def deadlines(self, kind: str | None = None) -> Deadlines:
        """The run's decisions of a kind (None: all), to be asserted about."""
        return Runs((self,)).deadlines(kind)


class Runs:
    """The runs of one scenario, one for each seed, in the order of the seeds asked for."""

    def __init__(self, runs: Sequence[Run]) -> None:
        self._runs = tuple(runs)

    def __getitem__(self, at: int) -> Run:
        return self._runs[at]

    def __len__(self) -> int:
        return len(self._runs)

    def __iter__(self) -> Iterator[Run]:
        return iter(self._runs)

    def deadlines(self, kind: str | None = None) -> Deadlines:
        """All runs' decisions of a kind (None: all), to be asserted about.

        Raises ValueError for an unknown kind, AssertionError for a run that is not whole.
        """
        if kind is not None and kind not in KINDS:
            raise ValueError(f"found the kind {kind!r}, expected one of {', '.join(KINDS)}")
        for run in self._runs:
            reasons = run.study.analysis.reasons
            if reasons:
                raise AssertionError(f"{run.log}: no verdict is honest: {'; '.join(reasons)}")
        settled = [
            Settled(run.seed, run.log, entry, _chain(run, entry))
            for run in self._runs
            for entry in run.ledger
            if kind in (None, entry.kind)
        ]
        return Deadlines(kind or "all", len(self._runs), tuple(settled))


def _chain(run: Run, entry: LedgerEntry) -> DecisionChain | None:
    found = (one for one in run.chains if (one.kind, one.decision) == (entry.kind, entry.decision))
    return next(found, None)


def run_wanted(wanted: Wanted, log: Path) -> Run:
    """Run a scenario in this process; its log goes to ``log``.

    Raises ScenarioError, ModuleRefusedError, LogWriteError.
    """
    prepared = prepare(wanted.scenario, wanted.changes, wanted.seed)
    script = prepared.script
    with script.open_log(log) as run_log:
        ended = run_in_process(script.scenario, prepared.drawn, run_log.write)
    return Run(script.scenario.seed, ended.reason, log)
