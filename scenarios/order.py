"""What the world's and the recorder's processes are told at their start: one JSON file."""

from __future__ import annotations

from pathlib import Path

import msgspec

from scenarios.run_record import Script


class Order(msgspec.Struct, frozen=True):
    """The run: its unique name, where the hub listens, where the log goes, and the script."""

    run: str
    endpoint: str
    log: str
    script: Script


def write_order(order: Order, path: Path) -> None:
    """Write the order for the processes of a run."""
    path.write_bytes(msgspec.json.encode(order))


def read_order(path: str) -> Order:
    """The order that the supervisor wrote."""
    return msgspec.json.decode(Path(path).read_bytes(), type=Order)
