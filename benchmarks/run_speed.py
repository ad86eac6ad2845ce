"""How fast a run goes: in separate processes over zenoh, and in one process; beside bare zenoh.

    python -m benchmarks.run_speed [--scenario NAME] [--repeats N] [--rounds N]

In one run of this program, so that the machine is the same for all: simulated seconds and
handlers by the second of wall time; the bare zenoh round trips that a turn cannot do without,
hub to process and process to process through the hub; from the launch to the first grant; and
``waywiser --help``. Best and median of the repeats are printed.
"""

from __future__ import annotations

import argparse
import contextlib
import queue
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import zenoh
from rich.console import Console
from rich.table import Table

from bus import link
from scenarios.launch import Launched, Prepared, launch_in_process, launch_processes, prepare

PING, PONG, READY = "bench/ping", "bench/pong", "bench/ready"
PAYLOAD = bytes(200)
"""About the size of a grant or of a small message."""

WARM_UP = 200


def echo(endpoint: str) -> None:
    """A process that sends back what it hears, until its parent has gone."""
    with link.open_client(endpoint) as session:
        back = link.publisher(session, PONG)
        heard: queue.SimpleQueue[tuple[str, bytes]] = queue.SimpleQueue()
        subscriber = link.subscribe(session, PING, heard.put)
        ready = link.publisher(session, READY)
        while True:
            try:
                _, data = heard.get(timeout=0.1)
            except queue.Empty:
                ready.put(b"")
                continue
            if not data:
                break
            back.put(data)
        del subscriber


def round_trips(session: zenoh.Session, rounds: int) -> float:
    """Seconds a round trip from this session to the echo and back, the mean of ``rounds``."""
    heard: queue.SimpleQueue[tuple[str, bytes]] = queue.SimpleQueue()
    ready: queue.SimpleQueue[tuple[str, bytes]] = queue.SimpleQueue()
    subscribers = [
        link.subscribe(session, PONG, heard.put),
        link.subscribe(session, READY, ready.put),
    ]
    out = link.publisher(session, PING)
    ready.get(timeout=30.0)
    began_s = 0.0
    for number in range(WARM_UP + rounds):
        if number == WARM_UP:
            began_s = time.perf_counter()
        out.put(PAYLOAD)
        heard.get(timeout=30.0)
    each_s = (time.perf_counter() - began_s) / rounds
    out.put(b"")
    del subscribers
    return each_s


@contextlib.contextmanager
def another(*arguments: str) -> Iterator[None]:
    """Another process of this program, which ends by itself."""
    command = [sys.executable, "-m", "benchmarks.run_speed", *arguments]
    with subprocess.Popen(command) as process:
        try:
            yield
            process.wait(timeout=30.0)
        finally:
            process.kill()


def from_hub(rounds: int) -> float:
    """Seconds a round trip from the hub's own process to another one."""
    endpoint = link.endpoint(0)
    with link.open_hub(endpoint) as session, another("--echo", endpoint):
        return round_trips(session, rounds)


def through_hub(rounds: int) -> float:
    """Seconds a round trip between two processes that are both clients of the hub."""
    endpoint = link.endpoint(0)
    with (
        link.open_hub(endpoint),
        another("--echo", endpoint),
        link.open_client(endpoint) as session,
    ):
        return round_trips(session, rounds)


def help_text() -> float:
    """Seconds that ``waywiser --help`` takes."""
    began_s = time.perf_counter()
    subprocess.run(
        [Path(sys.executable).with_name("waywiser"), "--help"], check=True, capture_output=True
    )
    return time.perf_counter() - began_s


def launches(prepared: Prepared, repeats: int, *, apart: bool) -> list[Launched]:
    """Runs of a scenario, each with a log of its own that is thrown away."""
    done: list[Launched] = []
    with tempfile.TemporaryDirectory() as folder:
        for number in range(repeats):
            log = Path(folder) / f"{number}.mcap"
            log.touch()
            if apart:
                done.append(launch_processes(prepared, log, lambda _: None))
            else:
                done.append(launch_in_process(prepared, log))
    return done


def row(
    name: str, values: Sequence[float], form: str, best: Callable[..., float] = min
) -> list[str]:
    """One line of the table: the best and the median."""
    return [name, format(best(values), form), format(statistics.median(values), form)]


def of_runs(name: str, runs: Sequence[Launched]) -> list[list[str]]:
    """The lines about one kind of run."""
    simulated = [run.simulated_s / run.wall_s for run in runs]
    handlers = [run.handlers / run.wall_s for run in runs]
    return [
        row(f"{name}: simulated seconds a second", simulated, ",.0f", max),
        row(f"{name}: handlers a second", handlers, ",.0f", max),
        row(f"{name}: wall time, s", [run.wall_s for run in runs], ".2f"),
    ]


def main() -> None:
    """Measure and print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scenario", default="aces")
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--rounds", type=int, default=5000)
    parser.add_argument("--echo", metavar="ENDPOINT", help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.echo:
        echo(given.echo)
        return
    prepared = prepare(given.scenario, (), None)
    launches(prepared, 1, apart=False)  # compiles what is compiled
    apart = launches(prepared, given.repeats, apart=True)
    repeats = range(given.repeats)
    table = Table(title=f"{given.scenario}: {apart[0].handlers:,} handlers a run")
    for column in ("", "best", "median"):
        table.add_column(column)
    lines = [
        *of_runs("separate processes", apart),
        *of_runs("in one process", launches(prepared, given.repeats, apart=False)),
        row("launch to first grant, s", [run.started_after_s for run in apart], ".2f"),
        row(
            "zenoh, hub to process and back, us",
            [1e6 * from_hub(given.rounds) for _ in repeats],
            ".0f",
        ),
        row(
            "zenoh, process to process and back, us",
            [1e6 * through_hub(given.rounds) for _ in repeats],
            ".0f",
        ),
        row("waywiser --help, s", [help_text() for _ in repeats], ".2f"),
    ]
    for line in lines:
        table.add_row(*line)
    Console().print(table)


if __name__ == "__main__":
    main()
