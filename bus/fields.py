"""Array fields of messages: what each may hold, checked when it arrives.

A field is annotated with a :class:`Spec`; :func:`check_arrays` refuses an array of another
dtype or shape, or one that is not the distribution it claims to be.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Annotated, Any, TypeAlias, get_type_hints

import msgspec
import numpy as np

from bus.grid import JUNCTION_TYPES


class FieldError(ValueError):
    """A message's field holds something its type does not allow."""


@dataclass(frozen=True)
class Spec:
    """What an array field must be: its dtype, its shape and what its numbers mean."""

    dtype: str
    dimensions: int
    meaning: str = "any"
    """``any``, ``finite``, ``costs`` (finite, not negative), ``likelihood`` (costs, not all zero)
    or ``distribution`` (a likelihood whose last axis sums to one)."""
    length: int | None = None
    """Of the last axis, where it is fixed."""
    rows: int | None = None
    """Of the first axis, where it is fixed."""


Floats: TypeAlias = Annotated[np.ndarray, Spec("float64", 1)]
FiniteFloats: TypeAlias = Annotated[np.ndarray, Spec("float64", 1, "finite")]
FiniteRows: TypeAlias = Annotated[np.ndarray, Spec("float64", 2, "finite")]
FloatPairs: TypeAlias = Annotated[np.ndarray, Spec("float64", 2, "finite", 2)]
Vector3: TypeAlias = Annotated[np.ndarray, Spec("float64", 1, "finite", 3)]
Matrix3: TypeAlias = Annotated[np.ndarray, Spec("float64", 2, "finite", 3)]
Distribution: TypeAlias = Annotated[np.ndarray, Spec("float64", 1, "distribution")]
Ints: TypeAlias = Annotated[np.ndarray, Spec("int64", 1)]
IntPairs: TypeAlias = Annotated[np.ndarray, Spec("int64", 2, length=2)]
Bytes1: TypeAlias = Annotated[np.ndarray, Spec("uint8", 1)]
Bytes2: TypeAlias = Annotated[np.ndarray, Spec("uint8", 2)]

# One number for each of the 16 junction types.
TypeDistribution: TypeAlias = Annotated[
    np.ndarray, Spec("float64", 1, "distribution", JUNCTION_TYPES)
]
TypeDistributions: TypeAlias = Annotated[
    np.ndarray, Spec("float64", 3, "distribution", JUNCTION_TYPES)
]
TypeRows: TypeAlias = Annotated[np.ndarray, Spec("float64", 2, "distribution", JUNCTION_TYPES)]
TypeLikelihood: TypeAlias = Annotated[np.ndarray, Spec("float64", 1, "likelihood", JUNCTION_TYPES)]
TypeFloats: TypeAlias = Annotated[np.ndarray, Spec("float64", 1, length=JUNCTION_TYPES)]
TypePairs: TypeAlias = Annotated[
    np.ndarray, Spec("float64", 2, "costs", JUNCTION_TYPES, JUNCTION_TYPES)
]
TypeInts: TypeAlias = Annotated[np.ndarray, Spec("int64", 1, length=JUNCTION_TYPES)]
TypeBytes: TypeAlias = Annotated[np.ndarray, Spec("uint8", 1, length=JUNCTION_TYPES)]

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
    if spec.length is not None and value.shape[-1] != spec.length:
        return f"found shape {value.shape}, expected {spec.length} along the last axis"
    if spec.rows is not None and value.shape[0] != spec.rows:
        return f"found shape {value.shape}, expected {spec.rows} along the first axis"
    return "" if spec.meaning == "any" else _meaning_problem(value, spec.meaning)


def _meaning_problem(value: np.ndarray, meaning: str) -> str:
    if not np.isfinite(value).all():
        return "holds a number that is not finite"
    if meaning == "finite":
        return ""
    if not value.size:
        return f"is empty, expected a {meaning}"
    if value.min() < 0.0:
        return f"holds {value.min()}, expected nothing below zero"
    if meaning == "costs":
        return ""
    if meaning == "likelihood":
        return "" if value.max() > 0.0 else "is zero everywhere, expected a positive likelihood"
    with np.errstate(over="ignore"):
        total = value.sum(axis=-1).ravel()
    worst = total[np.abs(total - 1.0).argmax()]
    return "" if abs(worst - 1.0) <= SUM_TOLERANCE else f"sums to {worst:.9g}, expected 1"
