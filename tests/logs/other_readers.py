"""Readers of MCAP that others have written, where they are installed."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from functools import cache
from pathlib import Path
from typing import Any

SCRIPT = Path(__file__).parent / "count_messages.cjs"
NO_NODE = "node with @mcap/core and a zstd (npm i @mcap/core fzstd; NODE_PATH) is not here"
NO_RERUN = "rerun (pip install rerun-sdk) is not on the PATH"
NEEDED = "require('@mcap/core'); require('node:zlib').zstdDecompressSync ?? require('fzstd')"


@cache
def has_node() -> bool:
    """Whether the reader that Foxglove and Lichtblick use can run here."""
    node = shutil.which("node")
    return (
        node is not None
        and not subprocess.run([node, "-e", NEEDED], capture_output=True).returncode
    )


def has_rerun() -> bool:
    """Whether Rerun's own check can run here."""
    return shutil.which("rerun") is not None


def read_with_node(path: Path) -> dict[str, dict[str, Any]]:
    """``messages`` (how many a topic) and ``schemas`` (name by topic), as @mcap/core finds them."""
    done = subprocess.run(["node", str(SCRIPT), str(path)], capture_output=True, text=True)
    assert not done.returncode, done.stderr
    found: dict[str, dict[str, Any]] = json.loads(done.stdout)
    return found


def drawn_by_rerun(path: Path, folder: Path) -> dict[str, set[str]]:
    """What Rerun makes of every topic: the names of its components, ``Points3D:colors`` say."""
    converted = folder / "run.rrd"
    for command in (("mcap", "convert", path, "-o", converted), ("rrd", "print", "-v", converted)):
        done = subprocess.run(["rerun", *map(str, command)], capture_output=True, text=True)
        assert not done.returncode, done.stdout + done.stderr
    found: dict[str, set[str]] = {}
    for topic, component in re.findall(r"/([\w/]+)@(\w+:\w+)", done.stdout):
        found.setdefault(topic, set()).add(component)
    return found


def check_with_rerun(path: Path) -> dict[str, str]:
    """The status of every topic that ``rerun mcap check`` finds in a file."""
    done = subprocess.run(
        ["rerun", "mcap", "check", "--full", str(path)], capture_output=True, text=True
    )
    assert not done.returncode, done.stdout + done.stderr
    rows = [line.split() for line in done.stdout.splitlines()]
    return {row[3].strip("/"): row[0] for row in rows if len(row) == 5 and row[2].isdigit()}
