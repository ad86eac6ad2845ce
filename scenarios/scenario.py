"""Scenario files: TOML in, a typed and checked scenario out.

Everything that a user can get wrong ends in a :class:`ScenarioError` that names the file, the
key, what was found and what was expected.
"""

from __future__ import annotations

import tomllib
from collections.abc import Iterator, Mapping, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated, Any, Literal

import msgspec

from bus.costs import KINDS
from bus.features import FEWEST, MOST, USUAL
from bus.topics import MODULES
from scenarios.explain import explained, one_of, out_of_range, shown
from scenarios.modules import settings_type
from scenarios.recall import RecallSettings
from simworld.laser_ring import TRANSDUCERS
from simworld.settings import ErrandSettings, NotNegative, Positive, RandomErrands, WorldSettings

SHIPPED = Path(__file__).parent
FIRST_YEAR, LAST_YEAR = 1970, 2500
"""Time in a log is nanoseconds since 1970 in 64 bits; a run may take decades of them."""


SIMULATED = ("floor_plan", "person", "door", "false_echo", "doorway", "clutter")
"""Keys of [world] that mean nothing to a real robot's log."""


class ScenarioError(ValueError):
    """A scenario that cannot be run: file, key, found, expected."""


class _Table(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A table of a scenario: unknown keys are errors."""


class Compute(_Table, frozen=True):
    """What computing costs. ``slower`` adds seconds to every piece of work of a kind."""

    profile: Literal["free", "host", "huey-1990"] = "host"
    processors: Annotated[int, msgspec.Meta(ge=1)] | Literal["one each"] = "one each"
    slower: dict[str, NotNegative] = {}


class Sensing(_Table, frozen=True):
    """Into how many wedges the space about a port is divided; the sensor model must be of as many.

    Another number than 8 needs a model of its own: ``waywiser calibrate detectors --wedges N``.
    """

    wedges: Annotated[int, msgspec.Meta(ge=FEWEST, le=MOST)] = USUAL.count


class Expect(_Table, frozen=True):
    """Something that must hold at the end, or the launch ends with status 1."""

    decision: Literal["sensing", "path", "reaction"] | None = None
    late: Annotated[int, msgspec.Meta(ge=0)] | None = None
    slack_at_least_s: float | None = None
    errands_done: Literal["all"] | Annotated[int, msgspec.Meta(ge=0)] | None = None
    true_map_at_least: Annotated[float, msgspec.Meta(ge=0, le=1)] | None = None
    collisions: Annotated[int, msgspec.Meta(ge=0)] | None = None


CONDITIONS = ("late", "slack_at_least_s", "errands_done", "true_map_at_least", "collisions")
"""What an expectation may ask for; ``decision`` only says of which decisions."""


class Fault(_Table, frozen=True):
    """A process that is killed at a simulated time."""

    kill: Literal["sensor", "detectors", "classifier", "geographer", "decider", "reactor"]
    at_s: NotNegative


class BusSettings(_Table, frozen=True):
    """Where the hub listens on loopback (0: any free port) and how long a hop takes.

    A module that computes for longer than ``patience_s`` by the wall clock counts as frozen;
    the first run on a machine compiles, which may take half a minute.
    """

    port: Annotated[int, msgspec.Meta(ge=0, le=65535)] = 0
    hop_s: Annotated[float, msgspec.Meta(ge=1e-9, le=1.0)] = 1e-4
    patience_s: Positive = 120.0


class Scenario(_Table, frozen=True):
    """A whole scenario file."""

    about: str
    world: WorldSettings
    seed: Annotated[int, msgspec.Meta(ge=0)] = 1
    epoch: Annotated[datetime, msgspec.Meta(tz=True)] = datetime(2026, 1, 1, tzinfo=UTC)
    errand: tuple[ErrandSettings, ...] = ()
    random_errands: RandomErrands | None = None
    recall: RecallSettings | None = None
    compute: Compute = Compute()
    sensing: Sensing = Sensing()
    modules: dict[str, dict[str, Any]] = {}
    bus: BusSettings = BusSettings()
    expect: tuple[Expect, ...] = ()
    fault: tuple[Fault, ...] = ()

    @property
    def epoch_ns(self) -> int:
        """The simulated time zero as Unix time."""
        return round(self.epoch.timestamp()) * 1_000_000_000


def shipped() -> list[str]:
    """The names of the scenarios that come with the project."""
    return sorted(path.stem for path in SHIPPED.glob("*.toml"))


def listing() -> str:
    """The shipped scenarios with what they are about, a line each."""
    about = {n: tomllib.loads((SHIPPED / f"{n}.toml").read_text())["about"] for n in shipped()}
    width = max(map(len, about))
    return "\n".join(f"  {name:<{width}}  {text}" for name, text in about.items())


def find(name: str | None) -> Path:
    """The file of a shipped scenario, or the path itself. Raises ScenarioError."""
    if name is None:
        raise ScenarioError(f"found no scenario, expected a TOML file or one of\n{listing()}")
    path = SHIPPED / f"{name}.toml"
    if path.is_file():
        return path
    path = Path(name)
    if path.is_file():
        return path
    found = "a folder" if path.is_dir() else "no such file"
    raise ScenarioError(f"{name}: found {found}, expected a TOML file or one of\n{listing()}")


def load(path: Path, changes: Sequence[str] = (), seed: int | None = None) -> Scenario:
    """Read a scenario; ``changes`` are KEY=VALUE as on the command line. Raises ScenarioError."""
    try:
        table = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise ScenarioError(f"{path}: found {error.strerror}, expected a readable file") from None
    except UnicodeDecodeError as error:
        raise ScenarioError(f"{path}: found {error}, expected text in UTF-8") from None
    except tomllib.TOMLDecodeError as error:
        raise ScenarioError(f"{path}: found {error}, expected TOML") from None
    for change in changes:
        _apply(table, change)
    if seed is not None:
        table["seed"] = seed
    return check(table, " ".join([str(path), *(f"--set {change}" for change in changes)]))


def check(table: Mapping[str, Any], name: str) -> Scenario:
    """A scenario from its table. Raises ScenarioError that begins with ``name``."""
    unusable = out_of_range(table)
    if unusable:
        raise ScenarioError(f"{name}: {unusable}")
    scenario: Scenario = _converted(table, Scenario, name, "")
    for module, settings in scenario.modules.items():
        if module not in MODULES:
            raise ScenarioError(
                f"{name}: modules.{module}: found an unknown module, "
                f"{one_of(module, sorted(MODULES))}"
            )
        _converted(settings, settings_type(module), name, f"modules.{module}")
    for said in _contradictions(scenario):
        raise ScenarioError(f"{name}: {said}")
    return scenario


def _converted(table: Any, kind: type[Any], name: str, under: str) -> Any:
    try:
        return msgspec.convert(table, kind)
    except msgspec.ValidationError as error:
        raise ScenarioError(f"{name}: {explained(error, table, kind, under)}") from None


def _contradictions(scenario: Scenario) -> Iterator[str]:
    """What each key alone would not show."""
    for kind in scenario.compute.slower:
        if kind not in KINDS:
            yield f"compute.slower.{kind}: found an unknown kind of work, {one_of(kind, KINDS)}"
    if not FIRST_YEAR <= scenario.epoch.year <= LAST_YEAR:
        yield (
            f"epoch: found the year {scenario.epoch.year}, "
            f"expected one from {FIRST_YEAR} to {LAST_YEAR}"
        )
    if scenario.errand and scenario.random_errands:
        yield "random_errands: found beside [[errand]], expected only one of the two"
    if scenario.recall is not None and scenario.world.start == "anywhere":
        yield (
            "world.start: found 'anywhere' beside [recall], expected where the robot truly is, one "
            "of recall.may_be_at"
        )
    yield from _not_recorded(scenario)
    for k, expect in enumerate(scenario.expect):
        if not any(getattr(expect, condition) is not None for condition in CONDITIONS):
            yield f"expect[{k}]: found no condition, expected one of {', '.join(CONDITIONS)}"


def _not_recorded(scenario: Scenario) -> Iterator[str]:
    """What cannot be had where a real robot's log is played back: it is as it was."""
    if scenario.world.carmen is None:
        return
    beside = {
        "errand": scenario.errand,
        "random_errands": scenario.random_errands,
        "recall": scenario.recall,
        **{f"world.{key}": getattr(scenario.world, key) for key in SIMULATED},
    }
    for key, found in beside.items():
        if found:
            yield (
                f"{key}: found beside world.carmen, expected none: where that robot went, and "
                f"what it met, is in its log"
            )
    if scenario.world.sonar.transducers != TRANSDUCERS:
        yield (
            f"world.sonar.transducers: found {scenario.world.sonar.transducers}, expected "
            f"{TRANSDUCERS} beside world.carmen: so many are made of a laser's scan"
        )


def _apply(table: dict[str, Any], change: str) -> None:
    """Carry out one KEY=VALUE: dots lead into tables, the value is TOML or else a string.

    A number leads into an array: ``errand.0.due_s=1000``.
    """
    key, equals, text = change.partition("=")
    *parents, last = names = key.strip().split(".")
    if not equals or not all(names):
        raise ScenarioError(f"--set {change}: found no KEY=VALUE, expected for example seed=2")
    try:
        value = tomllib.loads(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError:
        value = text
    inner: Any = table
    for k, parent in enumerate(parents):
        inner, outer = _inner(inner, parent), inner
        wanted = dict if k == len(parents) - 1 else dict | list
        if not isinstance(inner, wanted):
            found = f"{'.'.join(parents[: k + 1])} = {shown(inner)}"
            if isinstance(outer, list) and inner is None:
                found = f"{'.'.join(parents[:k])} with {len(outer)} entries"
            raise ScenarioError(f"--set {change}: found {found}, expected a table there")
    inner[last] = value


def _inner(table: Any, name: str) -> Any:
    """What a name leads to: in an array an entry by its number, None where there is none."""
    if not isinstance(table, list):
        return table.setdefault(name, {})
    entry = int(name) if name.isdecimal() else len(table)
    return table[entry] if entry < len(table) else None
