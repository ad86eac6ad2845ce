"""Assertions about deadlines, with messages that show the worst decision."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from bus.messages import LedgerEntry
from logs.binomial import lower_bound, trials_needed
from logs.chains import DecisionChain
from logs.decisions import NEVER, NS_PER_S, cause_of, on_time
from scenarios.testing.durations import seconds


@dataclass(frozen=True)
class Settled:
    """One decision of one run; ``chain`` is what led to it, None where it never came."""

    seed: int
    log: Path
    entry: LedgerEntry
    chain: DecisionChain | None

    @property
    def slack_s(self) -> float:
        """Deadline less decision time; minus infinity for one that never came."""
        came = self.entry.decided_ns != NEVER
        return self.entry.slack_ns / NS_PER_S if came else float("-inf")


@dataclass(frozen=True)
class Deadlines:
    """The decisions of a kind in some runs.

    Each assertion returns True or raises AssertionError; with no decision at all it raises,
    since what nobody decided was not in time.
    """

    kind: str
    runs: int
    settled: tuple[Settled, ...]

    def all_met(self) -> bool:
        """Every decision was heard by its deadline."""
        __tracebackhide__ = True
        self._some()
        late = [one for one in self.settled if not on_time(one.entry)]
        if late:
            raise AssertionError(self._told(f"{self._share(len(late))} were late", late))
        return True

    def slack_at_least(self, least: str | float) -> bool:
        """Every decision came at least so long before its deadline: ``"5 s"``, or seconds."""
        __tracebackhide__ = True
        least_s = seconds(least)
        self._some()
        short = [one for one in self.settled if one.slack_s < least_s]
        if short:
            what = f"{self._share(len(short))} had less slack than {least_s:g} s"
            raise AssertionError(self._told(what, short))
        return True

    def met_with(self, probability: float, confidence: float = 0.95) -> bool:
        """Deadlines are met with at least this probability, at this confidence.

        By the exact one-sided binomial bound (Clopper and Pearson), which takes decisions as
        independent. Raises ValueError where either is not between 0 and 1.
        """
        __tracebackhide__ = True
        if not (0.0 < probability < 1.0 and 0.0 < confidence < 1.0):
            raise ValueError(f"found {probability} and {confidence}, expected both within 0 and 1")
        self._some()
        late = [one for one in self.settled if not on_time(one.entry)]
        trials, met = len(self.settled), len(self.settled) - len(late)
        shown = lower_bound(met, trials, confidence)
        if shown < probability:
            what = (
                f"{met} of {trials} {self.kind} decisions were in time, which at {confidence:.0%} "
                f"confidence shows a probability of {shown:.4f}, expected {probability:g}; without "
                f"a miss it takes {trials_needed(probability, confidence)} decisions to show that"
            )
            raise AssertionError(self._told(what, late))
        return True

    def _some(self) -> None:
        if not self.settled:
            raise AssertionError(f"no {self.kind} decision was settled in {self.runs} runs")

    def _share(self, number: int) -> str:
        return f"{number} of {len(self.settled)} {self.kind} decisions in {self.runs} runs"

    def _told(self, what: str, bad: Sequence[Settled]) -> str:
        if not bad:
            return what
        worst = min(bad, key=lambda one: (one.slack_s, one.seed, one.entry.decision))
        seeds = dict.fromkeys(one.seed for one in bad)
        lines = [what, f"worst: {_decision_words(worst)}"]
        if worst.chain is not None:
            lines.append(f"       {_chain_words(worst.chain)}")
        lines.append(f"seeds: {', '.join(map(str, seeds))}")
        lines.append(f"open it: {how_to_open(worst.log)}")
        return "\n".join(lines)


def how_to_open(log: Path) -> str:
    """The command that shows a log."""
    return f"waywiser analyse {log} --html {log.with_suffix('.html')}"


def _decision_words(one: Settled) -> str:
    entry = one.entry
    times = f"asked at {_s(entry.asked_ns)}, due at {_s(entry.until_ns)}"
    came = (
        "never decided"
        if entry.decided_ns == NEVER
        else f"decided at {_s(entry.decided_ns)}, slack {one.slack_s:.6g} s"
    )
    why = "" if on_time(entry) else f", cause: {cause_of(entry)}"
    name = f"{entry.kind} {entry.decision} (visit {entry.visit}) of seed {one.seed}"
    return f"{name}: {times}, {came}{why}"


def _chain_words(one: DecisionChain) -> str:
    longest = one.chain.longest
    way = " > ".join(one.chain.topics)
    if longest is None:
        return way
    hop, part, took_ns = longest
    return f"{way}; longest: {hop.process} {part} {hop.topic}, {_s(took_ns)}"


def _s(time_ns: int) -> str:
    return f"{time_ns / NS_PER_S:.3f} s"
