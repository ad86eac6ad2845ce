"""A learned estimate of what each method costs and brings, and the choice by it (section 4).

"We therefore anticipate the need to develop estimation functions for the costs of using each
method." Here they are linear in the :mod:`features`, fitted on errands simulated in worlds drawn
from the exact belief over all connected maps (``python -m benchmarks.methods --train``) and kept
as numbers.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from importlib import resources
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
from numpy.typing import NDArray

from modules.decider.methods.features import FEATURES, Outlook, features
from modules.decider.methods.ways import METHODS, Method
from modules.decider.roads import Roads

VERSION = 1


class EstimatesError(ValueError):
    """A file of estimates that does not fit: file, key, found, expected."""


@dataclass(frozen=True)
class Estimate:
    """What an errand by one method is expected to cost and to bring."""

    method: Method
    seconds: float
    nats: float
    """By how much the entropy of the belief about the map falls."""
    later_s: float
    """Seconds of one later errand between any two places, with what was learnt."""

    def total_s(self, later_errands: float) -> float:
        """Seconds of this errand and of the expected later ones."""
        return self.seconds + later_errands * self.later_s


class _Coefficients(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    corridors: list[float]
    nats: list[float]
    later_corridors: list[float]


class Estimates(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The fitted numbers, as the file has them: one a feature."""

    version: int
    about: str
    features: list[str]
    methods: dict[str, _Coefficients]

    def of(self, roads: Roads, outlook: Outlook) -> tuple[Estimate, ...]:
        """An estimate for every method, in the order of METHODS.

        No errand is estimated at less than the shortest way that may exist.
        """
        x = features(roads, outlook)
        mean_s = float(roads.seconds.mean())
        return tuple(
            Estimate(
                method,
                mean_s * max(float(x[1]), dot(given.corridors, x)),
                max(0.0, dot(given.nats, x)),
                mean_s * max(0.0, dot(given.later_corridors, x)),
            )
            for method, given in ((m, self.methods[m]) for m in METHODS)
        )


def dot(coefficients: list[float], x: NDArray[np.float64]) -> float:
    """Sum of products in a fixed order, so that every machine gives the same bits."""
    return float(sum(c * v for c, v in zip(coefficients, x.tolist(), strict=True)))


def choose_method(estimates: tuple[Estimate, ...], later_errands: float) -> Estimate:
    """The method of least estimated time, this errand and the later ones; ties to the first."""
    return min(estimates, key=lambda e: e.total_s(later_errands))


@cache
def shipped_estimates() -> Estimates:
    """The estimates that come with the package."""
    file = resources.files("modules.decider.methods") / "estimates.json"
    return parse_estimates(file.read_bytes(), "modules/decider/methods/estimates.json")


def read_estimates(path: Path) -> Estimates:
    """The estimates in a file. Raises EstimatesError, OSError."""
    return parse_estimates(path.read_bytes(), str(path))


def parse_estimates(text: bytes, name: str) -> Estimates:
    """Estimates from JSON; ``name`` says where it is from. Raises EstimatesError."""
    try:
        found = msgspec.json.decode(text, type=Estimates)
    except msgspec.DecodeError as error:
        raise EstimatesError(f"{name}: {error}") from error
    _expect(name, "version", found.version, VERSION)
    _expect(name, "features", found.features, list(FEATURES))
    _expect(name, "methods", sorted(found.methods), sorted(METHODS))
    for method, given in found.methods.items():
        for key in ("corridors", "nats", "later_corridors"):
            _expect(
                name, f"methods.{method}.{key}: length", len(getattr(given, key)), len(FEATURES)
            )
    return found


def _expect(name: str, key: str, found: Any, expected: Any) -> None:
    if found != expected:
        raise EstimatesError(f"{name}: {key}: found {found!r}, expected {expected!r}")
