"""Analysing a long log: ours in one sequential pass, against the mcap package's ordered reader.

    python benchmarks/analyse_log.py [--messages 1000000]

Makes a log by repeating one made-up LDP after the other, with the mix of topics of a real run,
in a temporary folder. Prints how long the whole analysis takes (chains, queues, traffic, beliefs
against the truth, ledger), the memory that it adds, and how long `make_reader` with
`iter_decoded_messages` takes to do no more than hand the same messages over, decoded. Times are
of the processor, since both have one thread.
"""

from __future__ import annotations

import argparse
import resource
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory

from bus import messages as m
from bus.topics import TOPICS
from bus.turns import Voice
from bus.wire import MessageId, Sent
from logs.run_log import RunLog
from logs.study import study

EPOCH_NS = 1_767_225_600 * 10**9
HOP_NS = 100_000
STEP_NS = 2 * 10**9
PINGS = 120
"""Firings of the ring from one LDP to the next: four minutes."""

GRID = 4
CORRIDORS = 24
MAPS = 32


class Day:
    """What is said, LDP after LDP: each process with its own numbers."""

    def __init__(self) -> None:
        self._voices: dict[str, Voice] = {}
        self._rng = np.random.default_rng(1)
        self.now_ns = 0

    def say(self, message: m.Message, source: str, *parents: MessageId) -> Sent:
        """Say something now."""
        voice = self._voices.setdefault(source, Voice(source))
        return voice.sent(message, self.now_ns, parents)

    def handled(self, sent: Sent, process: str, cells: int) -> Sent:
        """The span of a handler that costs nothing."""
        start_ns = sent.said_ns + HOP_NS
        of = (process, sent.topic, sent.source, sent.sequence)
        return self.say(m.Span(*of, start_ns, start_ns, cells), "clock", sent.id)

    def building(self) -> Sent:
        """The building of all corridors."""
        lines = np.linspace(0.0, 60.0, GRID)
        corridors = np.ones(CORRIDORS, np.uint8)
        return self.say(m.TrueBuilding(lines, lines, 2.0, corridors, 0), "world")

    def ping(self, number: int) -> Iterator[Sent]:
        """A firing of the ring while driving, and what becomes of it."""
        ranges_m = self._rng.uniform(0.5, 6.0, 24)
        moved = self.say(m.Odometry(0.17, 0.0, 2.0), "world")
        sonar = self.say(m.Sonar(number, 0, self.now_ns, ranges_m), "world")
        yield from (moved, sonar)
        self.now_ns += HOP_NS
        yield from (self.handled(moved, "sensor", 9), self.handled(sonar, "sensor", 24))
        sigma_m, echo = np.full(24, 0.02), np.full(24, 0.97)
        believed = m.Ranges(number, self.now_ns, ranges_m, sigma_m, echo, 0.085)
        ranges = self.say(believed, "sensor", sonar.id, moved.id)
        yield ranges
        self.now_ns += HOP_NS
        yield from (self.handled(ranges, "reactor", 57), self.handled(ranges, "detectors", 1))

    def corridor(self, visit: int) -> Iterator[Sent]:
        """From one LDP to the next: a belief, two decisions, the pings, the arrival."""
        until_ns = self.now_ns + PINGS * STEP_NS
        left = self.say(m.Departure(visit, 1), "world")
        none = np.zeros(0, np.int64)
        question = m.AskedPath(
            visit, visit, none, none.reshape(0, 2), np.zeros(0), self.now_ns, until_ns
        )
        asked = self.say(question, "world")
        yield from (left, asked)
        self.now_ns += HOP_NS
        yield from (self.handled(left, "geographer", 9000), self.handled(asked, "decider", 1))
        belief = self.say(self._belief(visit), "geographer", left.id)
        yield belief
        self.now_ns += HOP_NS
        yield self.handled(belief, "decider", 500)
        each = np.zeros(16)
        ways = np.ones(16, np.uint8)
        answer = m.PathDecision(visit, visit, ways, each, each, ways, 8)
        decision = self.say(answer, "decider", belief.id, asked.id)
        yield decision
        self.now_ns += HOP_NS
        yield self.handled(decision, "world", 0)
        began_ns, slack_ns = asked.said_ns, until_ns - self.now_ns
        entry = (began_ns, until_ns, self.now_ns, slack_ns, 500, 8, 0, "", "")
        yield self.say(m.LedgerEntry(visit, "path", visit, *entry), "world")
        for number in range(PINGS):
            yield from self.ping(visit * PINGS + number)
            self.now_ns += STEP_NS - 2 * HOP_NS
        yield self.say(m.Arrival(visit, 1, 240.0), "world")
        yield self.say(m.TruePose(0.0, 0.0, 0.0, visit % GRID**2), "world")

    def _belief(self, visit: int) -> m.MapBelief:
        maps = self._rng.integers(0, 2, (MAPS, CORRIDORS), dtype=np.uint8)
        return m.MapBelief(
            visit,
            *(visit % GRID, 0, 1),
            np.full((GRID, GRID, 16), 1 / 16),
            np.full(CORRIDORS, 0.5),
            np.full(CORRIDORS, 240.0),
            *(-1.0, 3.0),
            maps,
            np.full(MAPS, 1 / MAPS),
            np.full(MAPS, -3.0),
        )


def day(messages: int) -> Iterator[Sent]:
    """At least so many messages, to the end of a corridor, and the end of the run."""
    said, visit = Day(), 0
    yield said.building()
    number = 1
    while number < messages:
        visit += 1
        for sent in said.corridor(visit):
            number += 1
            yield sent
    yield said.say(m.RunEnded("done"), "world")


def make_log(path: Path, messages: int) -> None:
    metadata = {"scenario": "made up", "seed": "1", "hop_ns": str(HOP_NS)}
    with RunLog(path, EPOCH_NS, metadata, {}) as log:
        for sent in day(messages):
            log.write(sent)


def ordered_reader(path: Path) -> int:
    """Hand over every message of the run's own topics, in the order of time, decoded."""
    with path.open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        return sum(1 for _ in reader.iter_decoded_messages(topics=list(TOPICS)))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--messages", type=int, default=1_000_000)
    wanted = parser.parse_args().messages
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "long.mcap"
        make_log(path, wanted)
        warm = Path(folder) / "short.mcap"
        make_log(warm, 1)
        print(f"log: {path.stat().st_size / 1e6:.0f} MB")
        study(warm)  # the first log that a machine ever sees waits for the compiler
        before_kib = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        began_s = time.process_time()
        found = study(path)
        ours_s = time.process_time() - began_s
        more_kib = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before_kib
        number = sum(of.number for of in found.traffic)
        print(
            f"analysis: {number:,} messages in {ours_s:.2f} s ({number / ours_s:,.0f} a second), "
            f"{len(found.chains):,} chains, {found.unknown_parents} parents unknown, "
            f"{more_kib / 1024:.0f} MiB more memory at most"
        )
        began_s = time.process_time()
        handed_over = ordered_reader(path)
        theirs_s = time.process_time() - began_s
        print(
            f"ordered reader: {handed_over:,} messages in {theirs_s:.2f} s "
            f"({handed_over / theirs_s:,.0f} a second)"
        )
        print(f"ratio: {theirs_s / ours_s:.1f}")


if __name__ == "__main__":
    main()
