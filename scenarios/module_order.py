"""What a module's process is told at its start. Light: it loads only the bus and its module."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import msgspec

from bus.costs import CostModel, Rate
from bus.facts import Facts


class Prices(msgspec.Struct, frozen=True):
    """A cost model, as it is written to a file."""

    profile: str
    rates: dict[str, Rate]
    extra_ns: dict[str, int]

    @property
    def costs(self) -> CostModel:
        """The cost model."""
        return CostModel(self.profile, self.rates, self.extra_ns)


class ModuleOrder(msgspec.Struct, frozen=True):
    """One module's part in a run."""

    name: str
    run: str
    endpoint: str
    facts: Facts
    settings: dict[str, Any]
    seed: int
    prices: Prices


def write_module_order(order: ModuleOrder, path: Path) -> None:
    """Write a module's order."""
    path.write_bytes(msgspec.json.encode(order))


def read_module_order(path: str) -> ModuleOrder:
    """The order that the supervisor wrote."""
    return msgspec.json.decode(Path(path).read_bytes(), type=ModuleOrder)
