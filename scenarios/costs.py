"""The compute profile of a scenario as a cost model."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path

from bus.costs import PROFILES, CostModel, Rate
from scenarios.scenario import Compute

HOST_FILE = Path(__file__).with_name("host_profile.json")
"""What this project's reference machine took, by kind of work."""


def cost_model(compute: Compute) -> CostModel:
    """The prices of a scenario's compute profile, with what it makes slower."""
    extra_ns = {kind: round(seconds * 1e9) for kind, seconds in compute.slower.items()}
    return CostModel(compute.profile, _rates(compute.profile), extra_ns)


def _rates(profile: str) -> Mapping[str, Rate]:
    if profile in PROFILES:
        return PROFILES[profile]
    table = json.loads(HOST_FILE.read_text(encoding="utf-8"))["rates"]
    return {kind: Rate(**rate) for kind, rate in table.items()}
