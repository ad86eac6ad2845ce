"""Scenario files: TOML in, a typed and checked scenario out.

Everything that a user can get wrong ends in a :class:`ScenarioError` that names the file, the
key, what was found and what was expected.
"""

from __future__ import annotations

import difflib
import re
import tomllib
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated, Any, Literal

import msgspec

from bus.costs import KINDS
from bus.topics import MODULES
from scenarios.modules import settings_type
from simworld.settings import ErrandSettings, NotNegative, RandomErrands, WorldSettings

SHIPPED = Path(__file__).parent


class ScenarioError(ValueError):
    """A scenario that cannot be run: file, key, found, expected."""


class _Table(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A table of a scenario: unknown keys are errors."""


class Compute(_Table, frozen=True):
    """What computing costs. ``slower`` adds seconds to every piece of work of a kind."""

    profile: Literal["free", "host", "huey-1990"] = "host"
    processors: Annotated[int, msgspec.Meta(ge=1)] | Literal["one each"] = "one each"
    slower: dict[str, NotNegative] = {}


class Expect(_Table, frozen=True):
    """Something that must hold at the end, or the launch ends with status 1."""

    decision: Literal["sensing", "path", "reaction"] | None = None
    late: Annotated[int, msgspec.Meta(ge=0)] | None = None
    slack_at_least_s: float | None = None
    errands_done: Literal["all"] | Annotated[int, msgspec.Meta(ge=0)] | None = None
    true_map_at_least: Annotated[float, msgspec.Meta(ge=0, le=1)] | None = None
    collisions: Annotated[int, msgspec.Meta(ge=0)] | None = None


class Fault(_Table, frozen=True):
    """A process that is killed at a simulated time."""

    kill: Literal["sensor", "detectors", "classifier", "geographer", "decider", "reactor"]
    at_s: NotNegative


class BusSettings(_Table, frozen=True):
    """Where the hub listens on loopback (0: any free port) and how long a hop takes."""

    port: Annotated[int, msgspec.Meta(ge=0, le=65535)] = 0
    hop_s: Annotated[float, msgspec.Meta(gt=0)] = 1e-4


class Scenario(_Table, frozen=True):
    """A whole scenario file."""

    about: str
    world: WorldSettings
    seed: Annotated[int, msgspec.Meta(ge=0)] = 1
    epoch: datetime = datetime(2026, 1, 1, tzinfo=UTC)
    errand: tuple[ErrandSettings, ...] = ()
    random_errands: RandomErrands | None = None
    compute: Compute = Compute()
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


def find(name: str) -> Path:
    """The file of a shipped scenario, or the path itself. Raises ScenarioError."""
    path = SHIPPED / f"{name}.toml"
    if path.is_file():
        return path
    path = Path(name)
    if path.is_file():
        return path
    raise ScenarioError(
        f"{name}: found no such file, expected a path to a scenario or one of "
        f"{', '.join(shipped())}"
    )


def load(path: Path, changes: Sequence[str] = (), seed: int | None = None) -> Scenario:
    """Read a scenario; ``changes`` are KEY=VALUE as on the command line. Raises ScenarioError."""
    try:
        table = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError) as error:
        raise ScenarioError(f"{path}: {error}") from None
    except tomllib.TOMLDecodeError as error:
        raise ScenarioError(f"{path}: found broken TOML, {error}") from None
    for change in changes:
        _apply(table, change)
    if seed is not None:
        table["seed"] = seed
    return check(table, str(path))


def check(table: Mapping[str, Any], name: str) -> Scenario:
    """A scenario from its table. Raises ScenarioError that begins with ``name``."""
    scenario: Scenario = _converted(table, Scenario, name, "")
    for module, settings in scenario.modules.items():
        if module not in MODULES:
            raise ScenarioError(
                f"{name}: modules.{module}: found an unknown module, "
                f"expected one of {', '.join(sorted(MODULES))}"
            )
        _converted(settings, settings_type(module), name, f"modules.{module}")
    for kind in scenario.compute.slower:
        if kind not in KINDS:
            raise ScenarioError(
                f"{name}: compute.slower.{kind}: found an unknown kind of work, "
                f"expected one of {', '.join(KINDS)}"
            )
    return scenario


def _converted(table: Any, kind: type[Any], name: str, under: str) -> Any:
    try:
        return msgspec.convert(table, kind)
    except msgspec.ValidationError as error:
        raise ScenarioError(f"{name}: {_explained(str(error), table, kind, under)}") from None


def _explained(text: str, table: Any, kind: type[Any], under: str) -> str:
    """A validation error with its key in front and what was found."""
    match = re.fullmatch(r"(.*?)(?: - at `(?:key in )?\$(.*)`)?", text)
    message, where = (match[1], match[2] or "") if match else (text, "")
    key = ".".join(part for part in (under, where.replace("[...]", "").lstrip(".")) if part)
    unknown = re.fullmatch(r"Object contains unknown field `(.*)`", message)
    if unknown:
        key = f"{key}.{unknown[1]}" if key else unknown[1]
        return f"{key}: found an unknown key{_did_you_mean(unknown[1], where, kind)}"
    found = _found(table, where)
    return f"{key or 'the file'}: found {found}, {message[0].lower()}{message[1:]}"


def _found(table: Any, where: str) -> str:
    value = table
    for name, index in re.findall(r"\.([A-Za-z_]\w*)|\[(\d+)\]", where):
        try:
            value = value[name] if name else value[int(index)]
        except (KeyError, IndexError, TypeError):
            return "something else"
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:57]}..."


def _did_you_mean(unknown: str, where: str, kind: type[Any]) -> str:
    names = _fields_at(kind, where)
    near = difflib.get_close_matches(unknown, names, n=1)
    if near:
        return f", expected {near[0]}?"
    return f", expected one of {', '.join(names)}" if names else ""


def _fields_at(kind: type[Any], where: str) -> list[str]:
    """The keys that a table may have, by following the path of an error through the types."""
    info: Any = msgspec.inspect.type_info(kind)
    for name in re.findall(r"\.([A-Za-z_]\w*)", where):
        fields = {field.encode_name: field.type for field in getattr(info, "fields", ())}
        info = _struct_in(fields.get(name))
    return [field.encode_name for field in getattr(info, "fields", ())]


def _struct_in(info: Any) -> Any:
    if isinstance(info, msgspec.inspect.UnionType):
        inner = [_struct_in(member) for member in info.types]
        return next((i for i in inner if isinstance(i, msgspec.inspect.StructType)), None)
    if isinstance(info, msgspec.inspect.VarTupleType):
        return _struct_in(info.item_type)
    return info


def _apply(table: dict[str, Any], change: str) -> None:
    """Carry out one KEY=VALUE: dots lead into tables, the value is TOML or else a string."""
    key, equals, text = change.partition("=")
    if not equals or not key.strip():
        raise ScenarioError(f"--set {change}: found no KEY=VALUE, expected for example seed=2")
    try:
        value = tomllib.loads(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError:
        value = text
    *parents, last = key.strip().split(".")
    inner: Any = table
    for parent in parents:
        inner = inner.setdefault(parent, {}) if isinstance(inner, dict) else None
    if not isinstance(inner, dict):
        raise ScenarioError(f"--set {key}: found no table to put it in")
    inner[last] = value
