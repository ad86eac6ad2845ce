"""A recorder that stalls must not slow the bus, and must keep what came meanwhile."""

from __future__ import annotations

import threading
from pathlib import Path

import zenoh

from bus import link
from bus.protocol import pack_commit
from bus.recording import Recording
from bus.topics import TOPICS
from bus.wire import Sent, pack
from logs.reader import read_run
from logs.recover import recover
from logs.run_log import RunLog
from logs.transcode import Taken, Taker
from tests.logs.endless_run import EPOCH_NS, message

GUARD_S = 60.0
NUMBER = 5_000


def _wait_until_ready(hub: zenoh.Session, keys: link.Keys) -> None:
    """Until the hub knows what the recorder listens to: what is said before that is lost."""
    ready = threading.Event()
    watch = link.watch_alive(hub, keys, lambda _process, _alive: ready.set())
    assert ready.wait(GUARD_S)
    watch.undeclare()  # type: ignore[no-untyped-call]


def _publish(hub: zenoh.Session, keys: link.Keys, said: list[Sent], due: list[Sent]) -> None:
    """Say some messages, then have ``due`` written; the recorder ends with the last of all."""
    publishers = {topic: link.publisher(hub, keys.topic(topic)) for topic in TOPICS}
    for sent in said:
        publishers[sent.topic].put(pack(sent))
    last = due[-1].sequence == NUMBER - 1
    link.publisher(hub, keys.commit).put(pack_commit([sent.id for sent in due], last=last))


def test_all_is_published_while_the_recorder_stands_still_and_nothing_is_lost(
    tmp_path: Path,
) -> None:
    said = [message(sequence) for sequence in range(NUMBER)]
    published = threading.Event()
    late: list[bool] = []
    at, keys = link.endpoint(0), link.Keys("stalls")
    with (
        link.open_hub(at) as hub,
        link.open_client(at) as session,
        RunLog(tmp_path / "a.mcap", EPOCH_NS, {}, {}) as log,
    ):

        def write(entries: list[Taken]) -> None:
            late.append(not published.wait(GUARD_S))  # the disk hangs until all is said
            log.record(entries)

        recording = Recording(session, keys, Taker().take, write)
        _wait_until_ready(hub, keys)
        recorder = threading.Thread(target=recording.run, daemon=True)
        recorder.start()
        _publish(hub, keys, said[:1], said[:1])  # the writer now stands still
        _publish(hub, keys, said[1:], said[1:])
        published.set()
        recorder.join(GUARD_S)
        assert not recorder.is_alive()
    assert not any(late)
    assert recording.lost == []
    assert [sent.sequence for sent in read_run(tmp_path / "a.mcap")] == list(range(NUMBER))


def test_what_never_came_is_counted_and_missing_from_the_log(tmp_path: Path) -> None:
    said = [message(sequence) for sequence in range(NUMBER - 20, NUMBER)]
    came = [sent for sent in said if sent.sequence not in (NUMBER - 16, NUMBER - 9)]
    at, keys = link.endpoint(0), link.Keys("loses")
    with (
        link.open_hub(at) as hub,
        link.open_client(at) as session,
        RunLog(tmp_path / "a.mcap", EPOCH_NS, {}, {}) as log,
    ):
        recording = Recording(session, keys, Taker().take, log.record, 0.1)
        _wait_until_ready(hub, keys)
        _publish(hub, keys, came, said)
        recording.run()
    assert recording.lost == [("world", NUMBER - 16), ("world", NUMBER - 9)]
    recovered = recover(tmp_path / "a.mcap", tmp_path / "b.mcap")
    assert (recovered.messages, recovered.missing) == (18, {"world": NUMBER - 18})
