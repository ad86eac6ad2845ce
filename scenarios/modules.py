"""The table of modules that a run is made of: who they are and how they are built.

The import of a module's package is put off until it is built, in the process that runs it.
"""

from __future__ import annotations

import importlib
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

import msgspec

from bus.facts import Facts
from bus.topics import MODULES
from bus.turns import Module


def _settings(name: str) -> type[msgspec.Struct]:
    found: type[msgspec.Struct] = importlib.import_module(f"modules.{name}.settings").Settings
    return found


MODULE_SETTINGS: Mapping[str, type[msgspec.Struct]] = MappingProxyType(
    {name: _settings(name) for name in sorted(MODULES)}
)
"""What a scenario may set in [modules.NAME]."""


def build_module(name: str, facts: Facts, settings: Mapping[str, Any], seed: int) -> Module:
    """A module ready to take turns. ``settings`` is its table in the scenario, checked."""
    package = importlib.import_module(f"modules.{name}.process")
    module: Module = package.build(facts, msgspec.convert(settings, MODULE_SETTINGS[name]), seed)
    return module
