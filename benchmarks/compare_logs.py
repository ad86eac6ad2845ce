"""Finding where two long logs part, and replaying the modules of a run.

    python -m benchmarks.compare_logs [--messages 1000000] [--scenario aces]

Makes two logs of so many messages in a temporary folder, equal but for one number at nine tenths
of the way, and prints how long the search for it takes and the memory that it adds; the same for
a tenth of the messages, since that memory must not grow. Then runs a scenario in this process and
replays each of its modules alone. Times are of the processor.
"""

from __future__ import annotations

import argparse
import resource
import tempfile
import time
from dataclasses import replace
from pathlib import Path

import msgspec

from benchmarks.analyse_log import EPOCH_NS, HOP_NS, day
from bus.messages import Sonar
from bus.topics import MODULES
from logs.first_difference import compare_logs
from logs.run_log import RunLog
from scenarios.launch import launch_in_process, prepare
from scenarios.replaying import replay


def make_logs(folder: Path, messages: int) -> tuple[Path, Path]:
    """Two logs that part at the first echo after nine tenths of the messages."""
    paths = folder / f"base-{messages}.mcap", folder / f"new-{messages}.mcap"
    metadata = {"scenario": "made up", "seed": "1", "hop_ns": str(HOP_NS)}
    with (
        RunLog(paths[0], EPOCH_NS, metadata, {}) as base,
        RunLog(paths[1], EPOCH_NS, metadata, {}) as new,
    ):
        parted = False
        for number, sent in enumerate(day(messages)):
            base.write(sent)
            if not parted and number > 0.9 * messages and isinstance(sent.message, Sonar):
                sent = replace(sent, message=msgspec.structs.replace(sent.message, ping=-1))
                parted = True
            new.write(sent)
    return paths


def search(folder: Path, messages: int) -> None:
    """Print how long the search takes, and what memory it adds."""
    base, new = make_logs(folder, messages)
    before_kib = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    began_s = time.process_time()
    found = compare_logs(base, new)
    took_s = time.process_time() - began_s
    more_kib = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before_kib
    assert found.first is not None
    print(
        f"search: {found.equal:,} equal messages in {took_s:.2f} s ({found.equal / took_s:,.0f} a "
        f"second), then {found.first.kind} of {found.first.topic}; {more_kib / 1024:.0f} MiB more"
    )


def replays(folder: Path, scenario: str) -> None:
    """Print how long the replay of each module takes."""
    log = folder / "run.mcap"
    launch_in_process(prepare(scenario, (), None), log)
    for module in MODULES:
        replay(log, module)  # what compiles, compiles here
        began_s = time.process_time()
        replayed = replay(log, module)
        took_s = time.process_time() - began_s
        assert replayed.first is None, replayed.first
        print(
            f"replay of {module}: {replayed.handlers:,} handlers, {replayed.said:,} messages equal "
            f"bit for bit, {took_s:.2f} s, {replayed.until_ns / 1e9 / took_s:,.0f} times real time"
        )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--messages", type=int, default=1_000_000)
    parser.add_argument("--scenario", default="aces")
    wanted = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        search(Path(folder), wanted.messages // 10)
        search(Path(folder), wanted.messages)
        replays(Path(folder), wanted.scenario)


if __name__ == "__main__":
    main()
