"""What the modules of a run are told at their start, kept in its log, so that each runs again.

A log can be replayed without its scenario and whatever the prices of computing are by then.
"""

from __future__ import annotations

from typing import Any

import msgspec

from bus.facts import Facts
from bus.topics import MODULES
from scenarios.costs import cost_model
from scenarios.ground import draw_ground, generator
from scenarios.module_order import Prices
from scenarios.scenario import Compute, Scenario

ATTACHMENT = "modules.json"
"""Under this name it is in the log."""


class PartsError(ValueError):
    """A log that does not say what its modules were told."""


class Parts(msgspec.Struct, frozen=True):
    """The facts that all are told, each module's settings, the run's seed, what computing costs."""

    facts: Facts
    settings: dict[str, dict[str, Any]]
    seed: int
    prices: Prices


def prices_of(compute: Compute) -> Prices:
    """What computing costs, in a form that can be written down."""
    costs = cost_model(compute)
    return Prices(costs.profile, dict(costs.rates), dict(costs.extra_ns))


def parts_of(scenario: Scenario) -> Parts:
    """What the modules of a scenario are told. Raises ScenarioError, BuildingError."""
    facts = draw_ground(scenario, generator(scenario)).facts
    settings = {name: scenario.modules.get(name, {}) for name in MODULES}
    return Parts(facts, settings, scenario.seed, prices_of(scenario.compute))


def pack_parts(parts: Parts) -> bytes:
    """For the log: JSON, a line each where it is long."""
    return msgspec.json.format(msgspec.json.encode(parts), indent=1) + b"\n"


def parts_in(attachments: dict[str, bytes], log: str) -> Parts:
    """What the modules of a recorded run were told. Raises PartsError that names the log."""
    data = attachments.get(ATTACHMENT)
    if data is None:
        raise PartsError(
            f"{log}: found no attachment {ATTACHMENT}, expected what the modules were told at "
            f"their start (a log of an earlier version does not have it)"
        )
    try:
        return msgspec.json.decode(data, type=Parts)
    except msgspec.MsgspecError as error:
        raise PartsError(f"{log}: attachment {ATTACHMENT}: {error}") from None
