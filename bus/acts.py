"""What a robot can do about something in its way: the words of ``decision/reaction``."""

from __future__ import annotations

from typing import Literal, TypeAlias, get_args

Act: TypeAlias = Literal[
    "continue",
    "slow",
    "stop",
    "pull aside left",
    "pull aside right",
    "pass left",
    "pass right",
    "back up",
]

ACTS: tuple[Act, ...] = get_args(Act)
"""All of them, in the order of every table by act."""
