"""Recovering: whatever is cut, what was written before is there, once, unaltered."""

from __future__ import annotations

import random
from dataclasses import dataclass
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap.reader import make_reader

from bus import messages as m
from bus.topics import TOPICS
from bus.wire import Sent
from logs.reader import LogReadError, read_run
from logs.recover import Recovered, recover
from logs.run_log import LogWriteError, RunLog
from logs.schema import encode
from logs.tail import tail_path
from tests.logs.endless_run import EPOCH_NS, S, message

NUMBER = 60


@dataclass(frozen=True)
class State:
    """Both files as they were on disk after a number of messages."""

    log: bytes
    tail: bytes


@dataclass(frozen=True)
class Story:
    """A run, and the files at every moment of it. ``states[n]`` is after n messages."""

    said: list[Sent]
    states: list[State]
    folder: Path

    def recovered(self, log: bytes, tail: bytes | None) -> tuple[Recovered, list[bytes]]:
        """What recover makes of two files; the data of our messages in their order."""
        path, out = self.folder / "cut.mcap", self.folder / "out.mcap"
        path.write_bytes(log)
        tail_path(path).unlink(missing_ok=True)
        if tail is not None:
            tail_path(path).write_bytes(tail)
        recovered = recover(path, out)
        with out.open("rb") as file:
            read = make_reader(file, validate_crcs=True).iter_messages(
                list(TOPICS), log_time_order=False
            )
            return recovered, [message.data for _, _, message in read]


def _files(path: Path) -> State:
    tail = tail_path(path)
    return State(path.read_bytes(), tail.read_bytes() if tail.exists() else b"")


def _write(path: Path, said: list[Sent]) -> bytes:
    with RunLog(path, EPOCH_NS, {"seed": "1"}, {"a.toml": b"a = 1\n"}) as log:
        for sent in said:
            log.write(sent)
    return path.read_bytes()


@pytest.fixture(scope="module")
def story(tmp_path_factory: pytest.TempPathFactory) -> Story:
    folder = tmp_path_factory.mktemp("story")
    said = [message(sequence) for sequence in range(NUMBER)]
    said.append(Sent("run/ended", "world", NUMBER, -1, NUMBER * 7 * S, (), m.RunEnded("done")))
    path = folder / "RUN.mcap"
    log = RunLog(path, EPOCH_NS, {"seed": "1"}, {"a.toml": b"a = 1\n"})
    states = [_files(path)]
    for sent in said:
        log.write(sent)
        states.append(_files(path))
    log.close()
    return Story(said, states, folder)


def test_at_every_moment_nothing_that_was_written_is_lost(story: Story) -> None:
    for number, state in enumerate(story.states[1:], 1):
        recovered, _ = story.recovered(state.log, state.tail)
        whole = (story.folder / "out.mcap").read_bytes()
        assert whole == _write(story.folder / "again.mcap", story.said[:number])
        assert (recovered.messages, recovered.missing, recovered.damage) == (number, {}, ())
        assert recovered.ended is recovered.whole is (number == NUMBER + 1)
        assert not recovered.closed


def test_a_log_without_a_message_is_recovered_as_one(story: Story) -> None:
    recovered, found = story.recovered(story.states[0].log, None)
    assert recovered == Recovered(0, 0, False, False, (), {})
    assert found == []


@settings(max_examples=150, deadline=None)
@given(data=st.data())
def test_cut_anywhere_what_was_whole_before_the_cut_is_there(
    story: Story, data: st.DataObject
) -> None:
    number = data.draw(st.integers(1, NUMBER + 1), label="messages written")
    state = story.states[number]
    log = state.log[: data.draw(st.integers(0, len(state.log)), label="bytes of the log")]
    tail = state.tail[: data.draw(st.integers(0, len(state.tail)), label="bytes of the tail")]
    try:
        _, found = story.recovered(log, tail)
    except LogReadError:
        assert len(log) < len(story.states[0].log)  # the head itself was cut
        return
    known = [encode(sent) for sent in story.said[:number]]
    places = [known.index(record) for record in found]  # none altered: ValueError if it were
    assert places == sorted(set(places))  # none twice, none out of order
    assert set(places) >= _safe(story, number, len(log), len(tail))


def _safe(story: Story, number: int, log_bytes: int, tail_bytes: int) -> set[int]:
    """The messages that were whole in the bytes that are left, by what grew when."""
    states = story.states[: number + 1]
    safe: set[int] = set()
    chunk: list[int] = []
    for place in range(number):
        if len(states[place + 1].log) > len(states[place].log) and chunk:
            safe |= set(chunk) if len(states[place + 1].log) <= log_bytes else set()
            chunk = []
        chunk.append(place)
    first_chunk_lost = not safe and len(states[-1].log) > len(states[0].log)
    if not first_chunk_lost:
        safe |= {place for place in chunk if len(states[place + 1].tail) <= tail_bytes}
    return safe


def test_a_whole_log_is_copied_bit_for_bit(story: Story) -> None:
    whole = _write(story.folder / "whole.mcap", story.said)
    recovered, _ = story.recovered(whole, None)
    assert (story.folder / "out.mcap").read_bytes() == whole
    assert recovered == Recovered(NUMBER + 1, 0, True, True, (), {})


def test_a_tail_whose_chunk_was_finished_is_not_added_again(story: Story) -> None:
    """A recorder may be killed after a chunk is written, before the tail is emptied."""
    before, after = next(
        (one, two)
        for one, two in zip(story.states[20:], story.states[21:], strict=False)
        if len(two.log) > len(one.log)
    )
    recovered, found = story.recovered(after.log, before.tail)
    assert recovered.from_tail == 0
    assert found == [encode(sent) for sent in story.said[: len(found)]]


def test_a_damaged_chunk_is_left_out_and_counted(story: Story) -> None:
    whole = bytearray(_write(story.folder / "whole.mcap", story.said))
    with (story.folder / "whole.mcap").open("rb") as file:
        summary = make_reader(file).get_summary()
    assert summary is not None
    chunk = summary.chunk_indexes[2]
    whole[chunk.chunk_start_offset + chunk.chunk_length - 20] ^= 0xFF
    recovered, found = story.recovered(bytes(whole), None)
    lost = NUMBER + 1 - len(found)
    assert 0 < lost < 15
    assert recovered.missing == {"world": lost}
    assert not recovered.whole
    assert [words.partition(":")[0] for words in recovered.damage] == [
        f"the chunk at byte {chunk.chunk_start_offset} is damaged"
    ]
    known = [encode(sent) for sent in story.said]
    assert found == [record for record in known if record in found]


@settings(max_examples=100, deadline=None)
@given(place=st.integers(0, 10**6), bit=st.integers(0, 7))
def test_no_flipped_bit_gets_an_altered_message_in(story: Story, place: int, bit: int) -> None:
    state = story.states[NUMBER]
    both = bytearray(state.log + state.tail)
    both[place % len(both)] ^= 1 << bit
    log, tail = bytes(both[: len(state.log)]), bytes(both[len(state.log) :])
    try:
        _, found = story.recovered(log, tail)
    except LogReadError:
        return
    known = [encode(sent) for sent in story.said]
    places = [known.index(record) for record in found]
    assert places == sorted(set(places))


def test_a_gap_in_what_was_recorded_is_still_a_gap(story: Story, tmp_path: Path) -> None:
    dropped = random.Random(1).sample(range(NUMBER), 7)
    _write(tmp_path / "a.mcap", [s for s in story.said if s.sequence not in dropped])
    recovered = recover(tmp_path / "a.mcap", tmp_path / "b.mcap")
    assert (recovered.missing, recovered.ended, recovered.whole) == ({"world": 7}, True, False)


def test_what_is_no_log_or_cannot_be_written_is_named(tmp_path: Path) -> None:
    (tmp_path / "a.txt").write_bytes(b"not a log at all")
    with pytest.raises(LogReadError, match=r"a.txt: found a file that is not MCAP"):
        recover(tmp_path / "a.txt", tmp_path / "b.mcap")
    assert not (tmp_path / "b.mcap").exists()
    path = tmp_path / "RUN.mcap"
    said = _write(path, [])
    with pytest.raises(LogReadError, match=r"RUN.mcap: found the log itself"):
        recover(path, path)
    assert path.read_bytes() == said
    with pytest.raises(LogWriteError, match=r"no/b.mcap: cannot write the log: No such file"):
        recover(path, tmp_path / "no" / "b.mcap")


def test_our_own_reader_takes_what_was_recovered(story: Story) -> None:
    state = story.states[25]
    story.recovered(state.log, state.tail)
    reader = read_run(story.folder / "out.mcap")
    assert [sent.sequence for sent in reader] == list(range(25))
    assert (reader.truncated, reader.attachments) == (False, {"a.toml": b"a = 1\n"})
