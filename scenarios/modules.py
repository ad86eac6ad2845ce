"""The modules that a run is made of: their settings and how they are built.

A module's package is imported only where it is needed: it may be heavy.
"""

from __future__ import annotations

import importlib
from collections.abc import Mapping
from typing import Any

import msgspec

from bus.facts import Facts
from bus.turns import Module

REFUSED = 2
"""Exit status of a module's process that cannot do what the scenario asks of it."""


class ModuleRefusedError(ValueError):
    """A module that cannot do what the scenario asks of it: which one, and its words."""


def settings_type(name: str) -> type[msgspec.Struct]:
    """What a scenario may set in [modules.NAME]."""
    found: type[msgspec.Struct] = importlib.import_module(f"modules.{name}.settings").Settings
    return found


def build_module(name: str, facts: Facts, settings: Mapping[str, Any], seed: int) -> Module:
    """A module ready to take turns. ``settings`` is its table in the scenario, checked.

    Raises ModuleRefusedError where the module has a ValueError of these facts or settings.
    """
    package = importlib.import_module(f"modules.{name}.process")
    checked = msgspec.convert(settings, settings_type(name))
    try:
        module: Module = package.build(facts, checked, seed)
    except ValueError as error:
        raise ModuleRefusedError(f"{name}: {error}") from error
    return module
