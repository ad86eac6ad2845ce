"""Keep the frontier's tables of wide grids in a cache folder that survives runs.

The folder is ``$XDG_CACHE_HOME/waywiser``, or ``~/.cache/waywiser``. A file that is damaged, cut
short or of another version is built again, with a note to this module's logger; a folder that
cannot be written or read costs time only. Files are written under another name and then moved, so
that processes that start together do not disturb each other, and they are mapped, not read, so
that they share the memory.
"""

from __future__ import annotations

import hashlib
import logging
import os
import struct
import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np

from modules.geographer.frontier import Frontier, Table, table_shapes

STORED_FROM = 8
"""The narrowest frontier whose tables are stored; narrower ones are built as fast as read."""

VERSION = 1
"""Of the file's layout and of what is in the tables; a test holds the tables against it."""

HEADER = struct.Struct("<8sII32s16x")
MAGIC = b"FRONTIER"

Progress = Callable[[int, int], None]
"""Called with what is done and what there is to do."""

_log = logging.getLogger(__name__)


class DamagedTablesError(ValueError):
    """A stored file is not what was written."""


def tables(width: int, progress: Progress | None = None, folder: Path | None = None) -> Frontier:
    """The frontier of a width, from the cache folder where there is one, else built and stored.

    `progress` is called while tables are built; `folder` is in place of the cache folder.
    """
    folder = folder or cache_folder()
    if folder is None or width < STORED_FROM:
        return Frontier.of(width, progress)
    path = folder / f"frontier-{width}.v{VERSION}"
    try:
        return read(path, width)
    except FileNotFoundError:
        pass
    except (OSError, DamagedTablesError) as error:
        _log.warning("tables of %d lines are built again: %s", width, error)
    frontier = Frontier.of(width, progress)
    try:
        write(path, frontier)
    except OSError as error:
        _log.info("tables of %d lines are not kept: %s", width, error)
    return frontier


def cache_folder() -> Path | None:
    """Where tables are kept, or None where the user has no home."""
    named = os.environ.get("XDG_CACHE_HOME", "")
    if Path(named).is_absolute():  # others are invalid (XDG Base Directory Specification)
        return Path(named) / "waywiser"
    try:
        return Path.home() / ".cache" / "waywiser"
    except RuntimeError:
        return None


def write(path: Path, frontier: Frontier) -> None:
    """Store tables. Raises OSError, with nothing left behind."""
    path.parent.mkdir(parents=True, exist_ok=True)
    payload = _bytes(frontier.enter) + _bytes(frontier.close)
    header = HEADER.pack(MAGIC, VERSION, frontier.width, hashlib.sha256(payload).digest())
    handle, temporary = tempfile.mkstemp(dir=path.parent, prefix=path.name)
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(header)
            file.write(payload)
        Path(temporary).replace(path)
    except OSError:
        Path(temporary).unlink(missing_ok=True)
        raise


def read(path: Path, width: int) -> Frontier:
    """Stored tables, checked. Raises OSError, DamagedTablesError."""
    enter, close = table_shapes(width)
    size = HEADER.size + 4 * (int(np.prod(enter)) + int(np.prod(close)))
    found = path.stat().st_size
    if found != size:
        raise DamagedTablesError(f"{path}: found {found} bytes, expected {size}")
    # Copy on write: nothing is written, but the kernels' compiled code is for writable arrays.
    content = np.memmap(path, np.uint8, "c")
    header = HEADER.pack(
        MAGIC, VERSION, width, hashlib.sha256(content[HEADER.size :].data).digest()
    )
    if content[: HEADER.size].tobytes() != header:
        raise DamagedTablesError(f"{path}: checksum or header does not fit its content")
    entries: Table = np.asarray(content[HEADER.size :]).view(np.int32)
    return Frontier.from_tables(
        width, entries[: np.prod(enter)].reshape(enter), entries[np.prod(enter) :].reshape(close)
    )


def _bytes(table: Table) -> bytes:
    return table.astype("<i4").tobytes()
