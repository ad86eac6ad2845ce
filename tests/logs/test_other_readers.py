"""A real run's log, read by programs that know nothing of ours."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import pytest
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory

from bus.topics import TOPICS
from logs.reader import read_run
from logs.recover import recover
from logs.run_log import RunLog
from logs.schema import schema_name
from logs.tail import tail_path
from logs.views import VIEWS
from scenarios.in_process import run_in_process
from scenarios.launch import prepare
from tests.logs.other_readers import (
    NO_NODE,
    NO_RERUN,
    check_with_rerun,
    drawn_by_rerun,
    has_node,
    has_rerun,
    read_with_node,
)

node = pytest.mark.skipif(not has_node(), reason=NO_NODE)
rerun = pytest.mark.skipif(not has_rerun(), reason=NO_RERUN)
FOXGLOVE = {topic: f"foxglove.{record.DESCRIPTOR.name}" for topic, record in VIEWS.items()}


@pytest.fixture(scope="module")
def killed_path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run of aces that stopped in the middle of a chunk."""
    path = tmp_path_factory.mktemp("aces") / "aces.mcap"
    prepared = prepare("aces", [], None)
    log = prepared.script.open_log(path)
    killed = path.with_name("killed.mcap")

    def write(sent: object) -> None:
        log.write(sent)  # type: ignore[arg-type]
        if log.path.stat().st_size > 500_000 and not killed.exists():
            killed.write_bytes(path.read_bytes())
            tail_path(killed).write_bytes(tail_path(path).read_bytes())

    run_in_process(prepared.script.scenario, prepared.drawn, write)
    log.close()
    return killed


@pytest.fixture(scope="module")
def aces_path(killed_path: Path) -> Path:
    """The whole run."""
    return killed_path.with_name("aces.mcap")


@pytest.fixture(scope="module")
def recovered_path(killed_path: Path) -> Path:
    """What was recovered of the run that was killed."""
    out = killed_path.with_name("recovered.mcap")
    recovered = recover(killed_path, out)
    assert (recovered.missing, recovered.damage, recovered.ended) == ({}, (), False)
    return out


def _counts(path: Path) -> dict[str, int]:
    reader = read_run(path, ())
    assert not list(reader)
    return {topic: number for topic, number in reader.counts.items() if number}


def _ours(messages: dict[str, int]) -> dict[str, int]:
    return {topic: number for topic, number in messages.items() if topic in TOPICS}


def _with_mcap(path: Path) -> dict[str, int]:
    with path.open("rb") as file:
        reader = make_reader(file, validate_crcs=True, decoder_factories=[DecoderFactory()])
        decoded = reader.iter_decoded_messages()
        return dict(Counter(channel.topic for _, channel, _, _ in decoded))


def test_mcaps_own_reader_decodes_every_message_and_every_view(
    aces_path: Path, recovered_path: Path
) -> None:
    found = _with_mcap(aces_path)
    assert _ours(found) == _counts(aces_path)
    assert sorted(set(found) - set(TOPICS)) == sorted(VIEWS)
    assert _ours(_with_mcap(recovered_path)) == _counts(recovered_path)


@node
@pytest.mark.parametrize("which", ["aces_path", "recovered_path"])
def test_the_reader_of_foxglove_and_lichtblick_counts_as_we_do(
    which: str, request: pytest.FixtureRequest
) -> None:
    path: Path = request.getfixturevalue(which)
    found = read_with_node(path)
    assert _ours(found["messages"]) == _counts(path)
    assert found["messages"] == _with_mcap(path)
    assert found["schemas"] == {topic: schema_name(topic) for topic in TOPICS} | FOXGLOVE


@rerun
@pytest.mark.parametrize("which", ["aces_path", "recovered_path"])
def test_rerun_finds_nothing_wrong(which: str, request: pytest.FixtureRequest) -> None:
    path: Path = request.getfixturevalue(which)
    found = check_with_rerun(path)
    assert set(found) >= set(_counts(path))
    assert set(found.values()) == {"ok"}


@rerun
def test_rerun_draws_the_robot_its_echoes_its_belief_and_the_words(
    aces_path: Path, tmp_path: Path
) -> None:
    drawn = drawn_by_rerun(aces_path, tmp_path)
    assert {"Points3D:positions", "Points3D:colors"} <= drawn["view/chances"]
    assert "Points3D:positions" in drawn["view/echoes"]
    assert "Transform3D:translation" in drawn["view/robot"]
    assert "TextLog:text" in drawn["view/log"]


def test_a_recovered_log_is_a_beginning_of_the_whole_one(
    aces_path: Path, recovered_path: Path
) -> None:
    def said(path: Path) -> list[tuple[str, int, bytes]]:
        with path.open("rb") as file:
            read = make_reader(file).iter_messages(log_time_order=False)
            return [(channel.topic, found.log_time, found.data) for _, channel, found in read]

    whole, beginning = said(aces_path), said(recovered_path)
    assert 3_000 < len(beginning) < len(whole)
    assert beginning == whole[: len(beginning)]


def test_the_channels_of_a_log_without_messages_are_known_too(tmp_path: Path) -> None:
    path = tmp_path / "empty.mcap"
    RunLog(path, 0, {}, {}).close()
    with path.open("rb") as file:
        summary = make_reader(file).get_summary()
    assert summary is not None
    names = {channel.topic: summary.schemas[n].name for n, channel in summary.channels.items()}
    assert names == {topic: schema_name(topic) for topic in TOPICS} | FOXGLOVE
