"""What is wrong with a table, in the words of its file: key, what was found, what was expected.

msgspec finds the error and says where; here the types are followed to that place, so that the
expected is what the type says there, not the library's wording.
"""

from __future__ import annotations

import difflib
import json
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from datetime import date, datetime
from types import UnionType
from typing import Annotated, Any, TypeAlias, Union, get_args, get_origin, get_type_hints

import msgspec
from msgspec import inspect

Step: TypeAlias = str | int | None
"""Into a table by key, into an array by index, or (None) into an entry that msgspec leaves open."""

LONGEST_SHOWN = 60
LARGEST_INTEGER = 2**63 - 1


@dataclass(frozen=True)
class _Place:
    """A place in a table: its key as a user would write it, its value and its type."""

    key: str
    value: Any
    kind: Any


def explained(error: msgspec.ValidationError, table: Any, kind: type[Any], under: str = "") -> str:
    """A validation error of ``table`` as a ``kind`` as "KEY: found ..., expected ...".

    ``under`` is the key of the table itself, empty for a whole file.
    """
    message, _, where = str(error).partition(" - at `")
    place = _Place(under, table, kind)
    for step in _steps(where):
        place = _into(place, step)
    field = re.fullmatch(r"Object (contains unknown|missing required) field `(.*)`", message)
    if field is None:
        found, expected = shown(place.value), described(place.kind)
        return f"{place.key or 'the file'}: found {found}, expected {expected}"
    key = _joined(place.key, field[2])
    if field[1] == "missing required":
        return f"{key}: found nothing, expected {described(_fields(place.kind)[field[2]])}"
    return f"{key}: found an unknown key, {one_of(field[2], list(_fields(place.kind)))}"


def one_of(found: str, known: Sequence[str]) -> str:
    """What was expected in place of an unknown name: the nearest known one, or all of them."""
    near = difflib.get_close_matches(found, known, n=1)
    if near:
        return f"expected {near[0]}?"
    return f"expected one of {', '.join(known)}" if known else "expected none here"


def out_of_range(table: Any, key: str = "") -> str | None:
    """The first number that no run can use (not finite, or beyond 64 bits), as "KEY: found ..."."""
    if isinstance(table, float) and not math.isfinite(table):
        return f"{key}: found {table}, expected a finite number"
    if isinstance(table, int) and abs(table) > LARGEST_INTEGER:
        return f"{key}: found {shown(table)}, expected at most {LARGEST_INTEGER}"
    return next(
        (said for inner, k in _entries(table, key) if (said := out_of_range(inner, k))), None
    )


def _entries(table: Any, key: str) -> Iterator[tuple[Any, str]]:
    if isinstance(table, Mapping):
        yield from ((value, _joined(key, name)) for name, value in table.items())
    elif isinstance(table, list):
        yield from ((value, f"{key}[{k}]") for k, value in enumerate(table))


def shown(value: Any) -> str:
    """A value as short as a message wants it."""
    if isinstance(value, Mapping):
        return f"a table of {', '.join(value)}" if value else "an empty table"
    if isinstance(value, bool):
        return str(value).lower()
    text = value.isoformat() if isinstance(value, date | datetime) else repr(value)
    return text if len(text) <= LONGEST_SHOWN else f"{text[: LONGEST_SHOWN - 3]}..."


def described(kind: Any) -> str:
    """What a type admits, in the words of TOML."""
    return _described(inspect.type_info(kind))


def _described(info: inspect.Type) -> str:
    match info:
        case inspect.UnionType():
            members = [m for m in info.types if not isinstance(m, inspect.NoneType)]
            return " or ".join(_described(member) for member in members)
        case inspect.LiteralType():
            return _listed([json.dumps(value) for value in info.values])
        case inspect.IntType() | inspect.FloatType():
            word = "integer" if isinstance(info, inspect.IntType) else "float"
            return word + _bounds(info)
        case inspect.VarTupleType():
            return f"array of {_described(info.item_type)}"
        case inspect.TupleType():
            return f"[{', '.join(_described(item) for item in info.item_types)}]"
        case inspect.StructType() | inspect.DictType():
            return "table"
        case inspect.DateTimeType():
            return "date and time with its offset, for example 2026-01-01T00:00:00Z"
    return {inspect.StrType: "string", inspect.BoolType: "true or false"}.get(type(info), "a value")


def _bounds(info: inspect.IntType | inspect.FloatType) -> str:
    signs = (">=", info.ge), (">", info.gt), ("<=", info.le), ("<", info.lt)
    return " and".join(f" {sign} {bound:g}" for sign, bound in signs if bound is not None)


def _listed(words: list[str]) -> str:
    return " or ".join(filter(None, (", ".join(words[:-1]), words[-1])))


def _steps(where: str) -> list[Step]:
    """The steps of a msgspec path: "$.world.columns_m[0]", "$.modules[...]"."""
    found = re.findall(r"\.([A-Za-z_]\w*)|\[(\d+)\]|(\[\.\.\.\])", where)
    return [name or (int(index) if index else None) for name, index, _ in found]


def _into(place: _Place, step: Step) -> _Place:
    if isinstance(step, str):
        kind = _fields(place.kind)[step]
        return _Place(_joined(place.key, step), place.value[step], kind)
    if isinstance(step, int):
        kind = _item(place.kind, step)
        return _Place(f"{place.key}[{step}]", place.value[step], kind)
    inner = next(get_args(k)[1] for k in _members(place.kind) if get_origin(k) is dict)
    name = next(name for name, value in place.value.items() if not _fits(value, inner))
    return _Place(_joined(place.key, name), place.value[name], inner)


def _fits(value: Any, kind: Any) -> bool:
    try:
        msgspec.convert(value, kind)
    except msgspec.ValidationError:
        return False
    return True


def _members(kind: Any) -> list[Any]:
    """The types that a union admits; of any other type, itself."""
    if get_origin(kind) is Annotated:
        return _members(get_args(kind)[0])
    if get_origin(kind) in (Union, UnionType):
        return [inner for member in get_args(kind) for inner in _members(member)]
    return [kind]


def _fields(kind: Any) -> dict[str, Any]:
    """The keys that a table may have, with their types."""
    for member in _members(kind):
        if isinstance(member, type) and issubclass(member, msgspec.Struct):
            hints = get_type_hints(member, include_extras=True)
            names = zip(member.__struct_encode_fields__, member.__struct_fields__, strict=True)
            return {key: hints[name] for key, name in names}
    return {}


def _item(kind: Any, index: int) -> Any:
    items = next(get_args(k) for k in _members(kind) if get_origin(k) is tuple)
    return items[0] if items[-1] is ... else items[index]


def _joined(key: str, name: str) -> str:
    return f"{key}.{name}" if key else name
