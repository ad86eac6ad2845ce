"""Array fields of messages: what each may hold, checked when it arrives.

A field is annotated with a :class:`Spec`; :func:`check_arrays` refuses an array of another
dtype or number of dimensions, or one that is not the distribution it claims to be.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Annotated, Any, TypeAlias, get_type_hints

import msgspec
import numpy as np


class FieldError(ValueError):
    """A message's field holds something its type does not allow."""


@dataclass(frozen=True)
class Spec:
    """What an array field must be: its dtype, its dimensions and what its numbers mean."""

    dtype: str
    dimensions: int
    meaning: str = "any"
    """``any``, ``finite``, ``likelihood`` (finite, not negative, not all zero) or
    ``distribution`` (a likelihood whose last axis sums to one)."""


Floats: TypeAlias = Annotated[np.ndarray, Spec("float64", 1)]
Floats2: TypeAlias = Annotated[np.ndarray, Spec("float64", 2, "finite")]
FiniteFloats: TypeAlias = Annotated[np.ndarray, Spec("float64", 1, "finite")]
Likelihood: TypeAlias = Annotated[np.ndarray, Spec("float64", 1, "likelihood")]
Distribution: TypeAlias = Annotated[np.ndarray, Spec("float64", 1, "distribution")]
Distributions3: TypeAlias = Annotated[np.ndarray, Spec("float64", 3, "distribution")]
Ints: TypeAlias = Annotated[np.ndarray, Spec("int64", 1)]
Ints2: TypeAlias = Annotated[np.ndarray, Spec("int64", 2)]
Bytes1: TypeAlias = Annotated[np.ndarray, Spec("uint8", 1)]
Bytes2: TypeAlias = Annotated[np.ndarray, Spec("uint8", 2)]

SUM_TOLERANCE = 1e-9


@cache
def array_specs(message_type: type[msgspec.Struct]) -> dict[str, Spec]:
    """The array fields of a message type and what each must be."""
    hints = get_type_hints(message_type, include_extras=True)
    found: dict[str, Spec] = {}
    for name, hint in hints.items():
        for extra in getattr(hint, "__metadata__", ()):
            if isinstance(extra, Spec):
                found[name] = extra
    return found


def check_arrays(message: msgspec.Struct) -> None:
    """Check every array field of a message. Raises FieldError that names the field."""
    for name, spec in array_specs(type(message)).items():
        problem = _problem(getattr(message, name), spec)
        if problem:
            raise FieldError(f"field {name!r}: {problem}")


def _problem(value: Any, spec: Spec) -> str:
    if not isinstance(value, np.ndarray):
        return f"found {type(value).__name__}, expected an array of {spec.dtype}"
    if value.dtype != spec.dtype or value.ndim != spec.dimensions:
        return (
            f"found {value.dtype} with shape {value.shape}, "
            f"expected {spec.dtype} with {spec.dimensions} dimension(s)"
        )
    return "" if spec.meaning == "any" else _meaning_problem(value, spec.meaning)


def _meaning_problem(value: np.ndarray, meaning: str) -> str:
    # One pass for the common case: a sum is finite only if every number is.
    total = value.sum(axis=-1) if meaning == "distribution" else value.sum()
    if not np.isfinite(total).all():
        return "holds a number that is not finite"
    if meaning == "finite":
        return ""
    if value.min() < 0.0:
        return f"holds {value.min()}, expected nothing below zero"
    if meaning == "likelihood":
        return "" if total > 0.0 else "is zero everywhere, expected a positive likelihood"
    worst = np.abs(total - 1.0).max()
    return "" if worst <= SUM_TOLERANCE else f"sums to {1.0 + worst:.9g}, expected 1"
