"""How differences are put into words."""

from __future__ import annotations

from logs.diff.contents import FieldDifference

_UNITS = (("s", 1_000_000_000), ("ms", 1_000_000), ("µs", 1_000), ("ns", 1))
FIELDS_SHOWN = 3


def duration(time_ns: int) -> str:
    """A time in a suitable unit, with all digits that it has."""
    unit, size = next(((u, s) for u, s in _UNITS if abs(time_ns) >= s), ("s", 1))
    return f"{time_ns / size:,.9f}".rstrip("0").rstrip(".") + f" {unit}"


def later(by_ns: int) -> str:
    """By how much something is later, or earlier."""
    return f"{duration(abs(by_ns))} {'later' if by_ns > 0 else 'earlier'}"


def changes(fields: tuple[FieldDifference, ...]) -> str:
    """The fields that differ, the first few of them."""
    shown = ", ".join(map(str, fields[:FIELDS_SHOWN]))
    left = len(fields) - FIELDS_SHOWN
    return shown + (f" and {left} more fields" if left > 0 else "")
