"""How many messages a second are recorded and read, in a process of its own.

Usage: ``python -m benchmarks.record_log [--messages 200000]``

The messages are those of a run of aces, said again and again at later times. Each line gives
messages a second by the wall clock and by the processor time of the process that does it:

- ``RunLog.write``: straight into the log, with views and tail.
- ``Taker.take, RunLog.record``: from the bytes of the wire, as the recorder does.
- ``over the bus``: a recorder process that gets them over zenoh; says how many were lost.
- ``mcap Writer``: the mcap package's own writer with the same bytes, encoded beforehand.
- ``read_run``: reading, with and without decoding; ``mcap StreamReader``: the same file.
"""

from __future__ import annotations

import argparse
import multiprocessing
import tempfile
import time
from collections.abc import Callable, Iterable
from dataclasses import replace
from multiprocessing.connection import Connection
from pathlib import Path

from mcap.records import Message
from mcap.stream_reader import StreamReader
from mcap.writer import Writer

from bus import link
from bus.protocol import pack_commit
from bus.recording import Recording
from bus.topics import RECORDER, TOPICS
from bus.wire import Sent, pack
from logs.mcap_file import CHUNK_BYTES
from logs.reader import read_run
from logs.run_log import RunLog
from logs.schema import encode, schema, schema_name
from logs.transcode import Taker
from scenarios.in_process import run_in_process
from scenarios.launch import prepare

EPOCH_NS = 1_767_225_600 * 10**9
COMMIT_BATCH = 500


def messages_of_aces(number: int) -> list[Sent]:
    """The messages of a run, repeated at later times, numbered on."""
    once: list[Sent] = []
    prepared = prepare("aces", [], None)
    run_in_process(prepared.script.scenario, prepared.drawn, once.append)
    lasts_ns = once[-1].said_ns + 10**9
    said: list[Sent] = []
    while len(said) < number:
        rounds, place = divmod(len(said), len(once))
        sent = once[place]
        later_ns = sent.said_ns + rounds * lasts_ns
        said.append(replace(sent, said_ns=later_ns, sequence=sent.sequence + rounds * len(once)))
    return said


def show(name: str, number: int, wall_s: float, processor_s: float, note: str = "") -> None:
    print(f"{name:<28}{number / wall_s:>12,.0f} /s{number / processor_s:>12,.0f} /s cpu  {note}")


def timed(name: str, number: int, action: Callable[[], object]) -> None:
    """Do it three times and show the best: other load of the machine only ever adds."""
    walls, processors = [], []
    for _ in range(3):
        wall, processor = time.perf_counter(), time.process_time()
        action()
        walls.append(time.perf_counter() - wall)
        processors.append(time.process_time() - processor)
    show(name, number, min(walls), min(processors))


def write_log(path: Path, said: Iterable[Sent]) -> None:
    with RunLog(path, EPOCH_NS, {}, {}) as log:
        for sent in said:
            log.write(sent)


def take_log(path: Path, wire: list[tuple[str, bytes]]) -> None:
    take = Taker().take
    with RunLog(path, EPOCH_NS, {}, {}) as log:
        for start in range(0, len(wire), COMMIT_BATCH):
            log.record([take(topic, data) for topic, data in wire[start : start + COMMIT_BATCH]])


def write_with_mcap(path: Path, encoded: list[tuple[str, int, int, bytes]]) -> None:
    with path.open("wb") as file:
        writer = Writer(file, chunk_size=CHUNK_BYTES)
        writer.start()
        channels: dict[str, int] = {}
        for topic in TOPICS:
            described = schema(topic).SerializeToString()
            number = writer.register_schema(schema_name(topic), "protobuf", described)
            channels[topic] = writer.register_channel(topic, "protobuf", number)
        for topic, sequence, stamp_ns, data in encoded:
            writer.add_message(channels[topic], stamp_ns, data, stamp_ns, sequence)
        writer.finish()  # type: ignore[no-untyped-call]


def read_decoded(path: Path) -> int:
    return sum(1 for _ in read_run(path))


def read_counted(path: Path) -> int:
    reader = read_run(path, ())
    return len(list(reader)) + reader.read


def read_with_mcap(path: Path) -> int:
    with path.open("rb") as file:
        return sum(isinstance(record, Message) for record in StreamReader(file).records)


def record(at: str, run: str, path: Path, answers: Connection) -> None:
    """The recorder's process."""
    with RunLog(path, EPOCH_NS, {}, {}) as log, link.open_client(at) as session:
        recording = Recording(session, link.Keys(run), Taker().take, log.record)
        started_s = time.process_time()
        recording.run()
    answers.send((time.process_time() - started_s, len(recording.lost)))


def over_the_bus(path: Path, said: list[Sent]) -> None:
    """Publish as fast as the bus takes it; the clock stops when the log is closed."""
    packed = [(sent.topic, sent.id, pack(sent)) for sent in said]
    at, run = link.endpoint(0), f"benchmark-{time.time_ns():x}"
    keys = link.Keys(run)
    here, there = multiprocessing.Pipe()
    with link.open_hub(at) as session:
        publishers = {topic: link.publisher(session, keys.topic(topic)) for topic in TOPICS}
        commits = link.publisher(session, keys.commit)
        recorder = multiprocessing.get_context("spawn").Process(
            target=record, args=(at, run, path, there)
        )
        recorder.start()
        while not list(session.liveliness().get(keys.alive(RECORDER))):
            time.sleep(0.05)
        began = time.perf_counter()
        for start in range(0, len(packed), COMMIT_BATCH):
            batch = packed[start : start + COMMIT_BATCH]
            for topic, _, data in batch:
                publishers[topic].put(data)
            last = start + COMMIT_BATCH >= len(packed)
            commits.put(pack_commit([name for _, name, _ in batch], last=last))
        published_s = time.perf_counter() - began
        processor_s, lost = here.recv()
        wall_s = time.perf_counter() - began
        recorder.join()
    whole = read_counted(path) == len(said)
    note = f"published in {published_s:.1f} s, {lost} lost, log {'whole' if whole else 'NOT WHOLE'}"
    show("over the bus", len(said), wall_s, processor_s, note)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--messages", type=int, default=200_000)
    number = parser.parse_args().messages
    said = messages_of_aces(number)
    wire = [(sent.topic, pack(sent)) for sent in said]
    encoded = [(s.topic, s.sequence, EPOCH_NS + s.said_ns, encode(s)) for s in said]
    size = sum(len(data) for _, _, _, data in encoded) / number
    print(f"{number:,} messages of {size:.0f} bytes on average")
    with tempfile.TemporaryDirectory() as folder:
        ours, theirs = Path(folder) / "ours.mcap", Path(folder) / "mcap.mcap"
        timed("RunLog.write", number, lambda: write_log(ours, said))
        timed("mcap Writer", number, lambda: write_with_mcap(theirs, encoded))
        timed("Taker.take, RunLog.record", number, lambda: take_log(ours, wire))
        over_the_bus(ours, said)
        timed("read_run, decoding", number, lambda: read_decoded(ours))
        timed("read_run, counting", number, lambda: read_counted(ours))
        timed("mcap StreamReader", number, lambda: read_with_mcap(ours))


if __name__ == "__main__":
    main()
