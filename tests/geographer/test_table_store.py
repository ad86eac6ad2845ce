from __future__ import annotations

import hashlib
import logging
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from modules.geographer import ConnectedMaps, table_store
from modules.geographer.frontier import Frontier
from modules.geographer.table_store import DamagedTablesError, cache_folder, read, tables, write

WIDTH = table_store.STORED_FROM


def assert_equal(found: Frontier, expected: Frontier) -> None:
    assert (found.width, found.idle, found.joined) == (
        expected.width,
        expected.idle,
        expected.joined,
    )
    assert (found.enter == expected.enter).all()
    assert (found.close == expected.close).all()
    assert found.enter.dtype == found.close.dtype == np.int32


@pytest.fixture
def building(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """The widths of tables as they are built."""
    built = []
    original = Frontier.of

    def counted(width: int, progress: table_store.Progress | None = None) -> Frontier:
        built.append(width)
        return original(width, progress)

    monkeypatch.setattr(Frontier, "of", counted)
    return built


def stored(folder: Path) -> Path:
    (path,) = folder.iterdir()
    return path


def test_tables_are_built_once(tmp_path: Path, building: list[int]) -> None:
    folder = tmp_path / "deep" / "cache"
    first = tables(WIDTH, folder=folder)
    again = tables(WIDTH, folder=folder)
    assert building == [WIDTH]
    assert_equal(again, first)


def test_narrow_tables_are_not_stored(tmp_path: Path) -> None:
    assert tables(WIDTH - 1, folder=tmp_path / "cache").width == WIDTH - 1
    assert not (tmp_path / "cache").exists()


@pytest.mark.parametrize("damage", ["a bit", "cut", "grown", "empty", "version", "other width"])
def test_damage_is_noticed_and_mended(
    damage: str, tmp_path: Path, building: list[int], caplog: pytest.LogCaptureFixture
) -> None:
    expected = tables(WIDTH, folder=tmp_path)
    path = stored(tmp_path)
    content = bytearray(path.read_bytes())
    if damage == "a bit":
        content[-1000] ^= 1
    elif damage == "version":
        content[8] ^= 1
    elif damage == "other width":
        content[12] ^= 1
    spoilt = {"cut": content[:-1], "grown": content + b"x", "empty": bytearray()}
    path.write_bytes(spoilt.get(damage, content))
    with pytest.raises(DamagedTablesError, match=path.name):
        read(path, WIDTH)
    with caplog.at_level(logging.WARNING):
        assert_equal(tables(WIDTH, folder=tmp_path), expected)
    assert "built again" in caplog.text
    assert path.name in caplog.text
    assert_equal(read(path, WIDTH), expected)
    assert building == [WIDTH, WIDTH]


def test_a_folder_that_cannot_be_written_costs_time_only(tmp_path: Path) -> None:
    in_the_way = tmp_path / "file"
    in_the_way.write_text("no folder")
    assert tables(WIDTH, folder=in_the_way).width == WIDTH
    assert tables(WIDTH, folder=in_the_way / "below").width == WIDTH


def test_a_file_that_cannot_be_read_costs_time_only(tmp_path: Path) -> None:
    path = tmp_path / f"frontier-{WIDTH}.v{table_store.VERSION}"
    path.mkdir()
    assert tables(WIDTH, folder=tmp_path).width == WIDTH


def test_a_full_disk_leaves_nothing_behind(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "replace", full)
    assert tables(WIDTH, folder=tmp_path).width == WIDTH
    assert list(tmp_path.iterdir()) == []


def test_a_copy_in_memory_cannot_change_the_file(tmp_path: Path) -> None:
    tables(WIDTH, folder=tmp_path)
    found = tables(WIDTH, folder=tmp_path)
    found.enter[:] = 0
    assert tables(WIDTH, folder=tmp_path).enter.any()


def test_beliefs_are_the_same_from_stored_tables(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    likelihood = np.random.default_rng(1).random((8, 8, 16))
    first, second = (ConnectedMaps(8, 8).posterior(likelihood) for _ in range(2))
    assert stored(tmp_path / "waywiser").stat().st_size > 0
    assert first.log_evidence == second.log_evidence
    assert (first.junctions == second.junctions).all()


def test_the_cache_folder(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", "/somewhere")
    assert cache_folder() == Path("/somewhere/waywiser")
    monkeypatch.setenv("XDG_CACHE_HOME", "relative")
    monkeypatch.setenv("HOME", "/home/huey")
    assert cache_folder() == Path("/home/huey/.cache/waywiser")

    def homeless() -> Path:
        raise RuntimeError

    monkeypatch.delenv("XDG_CACHE_HOME")
    monkeypatch.setattr(Path, "home", homeless)
    assert cache_folder() is None
    assert tables(WIDTH).width == WIDTH


def test_progress_is_told_while_tables_are_built(tmp_path: Path) -> None:
    told: list[tuple[int, int]] = []
    tables(WIDTH, lambda *done: told.append(done), tmp_path)
    assert told == [(column, WIDTH) for column in range(WIDTH + 1)]
    tables(WIDTH, lambda *done: told.append(done), tmp_path)
    assert len(told) == WIDTH + 1


def test_processes_that_start_together_do_not_disturb_each_other(tmp_path: Path) -> None:
    program = f"from modules.geographer.table_store import tables; assert tables({WIDTH}).joined"
    environment = os.environ | {"XDG_CACHE_HOME": str(tmp_path)}
    started = [subprocess.Popen([sys.executable, "-c", program], env=environment) for _ in range(3)]
    assert [process.wait() for process in started] == [0, 0, 0]
    assert_equal(read(stored(tmp_path / "waywiser"), WIDTH), Frontier.of(WIDTH))


def test_the_version_belongs_to_these_tables(tmp_path: Path) -> None:
    # Where this fails the tables have changed: stored ones are wrong, so VERSION must change too.
    write(tmp_path / "tables", Frontier.of(5))
    digest = hashlib.sha256((tmp_path / "tables").read_bytes()).hexdigest()
    assert (table_store.VERSION, digest[:16]) == (1, "c41211201bd2ece5")
