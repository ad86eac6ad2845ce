"""Durations as tests write them."""

from __future__ import annotations

import re

_UNITS = {"ns": 1e-9, "us": 1e-6, "ms": 1e-3, "s": 1.0, "min": 60.0, "h": 3600.0}
_WRITTEN = re.compile(r"\s*([-+]?[0-9.]+(?:e[-+]?[0-9]+)?)\s*([a-z]+)\s*")


def seconds(duration: str | float) -> float:
    """A number of seconds from ``"5 s"``, ``"200 ms"``, ``"4 min"`` or a number of them.

    Raises ValueError.
    """
    if not isinstance(duration, str):
        return float(duration)
    written = _WRITTEN.fullmatch(duration)
    if written is None or written[2] not in _UNITS:
        units = ", ".join(_UNITS)
        raise ValueError(f"found {duration!r}, expected a number and a unit of {units}: '5 s'")
    return float(written[1]) * _UNITS[written[2]]
