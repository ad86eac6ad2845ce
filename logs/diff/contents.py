"""In which fields two messages of one topic differ, bit for bit."""

from __future__ import annotations

import struct
from dataclasses import dataclass
from typing import Any

import numpy as np
from msgspec.structs import astuple

from bus.wire import Sent

SHOWN = 60
"""A value is shown with at most so many characters."""


@dataclass(frozen=True)
class FieldDifference:
    """A field that differs: its name, ``known_s[4]`` say for an element, and both values.

    ``others`` is how many more elements of the same field differ.
    """

    field: str
    base: str
    new: str
    others: int = 0

    def __str__(self) -> str:
        more = f" (and {self.others} more of it)" if self.others else ""
        return f"{self.field} {self.base} -> {self.new}{more}"


def field_differences(base: Sent, new: Sent) -> tuple[FieldDifference, ...]:
    """What differs in parents and fields; neither the numbers of the messages nor their times."""
    found: list[FieldDifference] = []
    names = base.message.__struct_fields__
    values = zip(names, astuple(base.message), astuple(new.message), strict=True)
    for name, one, other in values:
        difference = _difference(name, one, other)
        if difference is not None:
            found.append(difference)
    if base.parents != new.parents:
        found.append(FieldDifference("parents", _names(base), _names(new)))
    return tuple(found)


def _names(sent: Sent) -> str:
    return shown(", ".join(f"{source} {sequence}" for source, sequence in sent.parents))


def _difference(name: str, one: Any, other: Any) -> FieldDifference | None:
    if isinstance(one, np.ndarray):
        return _array_difference(name, one, other)
    if _bits(one) == _bits(other):
        return None
    return FieldDifference(name, shown(one), shown(other))


def _bits(value: Any) -> Any:
    return struct.pack("<d", value) if isinstance(value, float) else value


def _array_difference(name: str, one: np.ndarray, other: np.ndarray) -> FieldDifference | None:
    if one.shape != other.shape:
        return FieldDifference(f"{name}: shape", str(one.shape), str(other.shape))
    words = np.dtype(f"u{one.dtype.itemsize}")
    unlike = np.argwhere(one.view(words) != other.view(words))
    if not len(unlike):
        return None
    where = tuple(unlike[0].tolist())
    element = f"{name}[{', '.join(map(str, where))}]"
    values = (shown(one[where].item()), shown(other[where].item()))
    return FieldDifference(element, *values, len(unlike) - 1)


def shown(value: Any) -> str:
    """A value as text, cut where it is long."""
    text = str(value)
    return text if len(text) <= SHOWN else f"{text[:SHOWN]}..."
