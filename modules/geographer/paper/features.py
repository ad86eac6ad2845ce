"""What is sensed: features X with one junction or two neighbours as parents, and readings S."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bus.grid import EAST, JUNCTION_TYPES, NORTH, OPPOSITE, Grid
from modules.geographer.paper.errors import FeatureError

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Feature:
    """A boolean X with its parents, and the reading S of its detector.

    `junctions` are one intersection, or two neighbouring ones: the network is then multiply
    connected. `present` is Pr(X=1|J), (16,) or (16, 16) over the parents' types, by geometry;
    `readings` is Pr(S|X), (2, classes) for X = 0 and 1, by calibration. Raises FeatureError.
    """

    name: str
    junctions: tuple[int, ...]
    present: Floats
    readings: Floats

    def __post_init__(self) -> None:
        if len(self.junctions) not in (1, 2) or len(set(self.junctions)) < len(self.junctions):
            raise FeatureError(
                f"{self.name}: found parents {self.junctions}, expected one or two intersections"
            )
        shape = (JUNCTION_TYPES,) * len(self.junctions)
        if self.present.shape != shape:
            raise FeatureError(
                f"{self.name}: present has shape {self.present.shape}, expected {shape}"
            )
        if self.readings.ndim != 2 or len(self.readings) != 2 or not self.readings.size:
            raise FeatureError(
                f"{self.name}: readings has shape {self.readings.shape}, expected (2, classes)"
            )
        if not ((self.present >= 0.0) & (self.present <= 1.0)).all():
            raise FeatureError(f"{self.name}: present is expected to lie in 0..1")
        if not (self.readings >= 0.0).all() or not np.allclose(self.readings.sum(axis=1), 1.0):
            raise FeatureError(f"{self.name}: the rows of readings are expected to sum to 1")

    @property
    def classes(self) -> int:
        """How many evidence classes S has."""
        return int(self.readings.shape[1])


def junction_features(
    junction: int, names: Sequence[str], present: Floats, readings: Floats
) -> list[Feature]:
    """The features of one junction as seen from one port.

    `present` (16, features) is Pr(X=1|J), `readings` (features, 2, classes) is Pr(S|X). Names get
    the junction's number in front, so that every junction can have the same features.
    """
    return [
        Feature(f"{junction}_{name}", (junction,), present[:, f].astype(np.float64), readings[f])
        for f, name in enumerate(names)
    ]


def corridor_features(grid: Grid, readings: Floats) -> list[Feature]:
    """For each corridor, whether it opens at both its ends: seen from one, it tells of the other.

    `readings` (2, classes) is Pr(S|X). These are the features that make the network multiply
    connected: "the presence of a feature at one junction can affect the classification of a
    neighboring junction" (paper, section 3).
    """
    return [_corridor_feature(grid, corridor, readings) for corridor in range(grid.corridors)]


def _corridor_feature(grid: Grid, corridor: int, readings: Floats) -> Feature:
    leaving = EAST if corridor < grid.east_corridors else NORTH
    types = np.arange(JUNCTION_TYPES)
    here, there = types & leaving > 0, types & OPPOSITE[leaving] > 0
    present = np.logical_and.outer(here, there).astype(np.float64)
    return Feature(f"corridor_{corridor}", grid.ends(corridor), present, readings)


def check_features(grid: Grid, features: Sequence[Feature]) -> None:
    """Raise FeatureError for names used twice, or parents that are not on the grid or no pair."""
    joined = {grid.ends(corridor) for corridor in range(grid.corridors)}
    names: dict[str, Feature] = {}
    for feature in features:
        if names.setdefault(feature.name, feature) is not feature:
            raise FeatureError(f"{feature.name}: found two features of this name")
        off = [v for v in feature.junctions if not 0 <= v < grid.intersections]
        if off:
            raise FeatureError(
                f"{feature.name}: found parents {off}, expected 0..{grid.intersections - 1}"
            )
        if len(feature.junctions) == 2 and tuple(sorted(feature.junctions)) not in joined:
            raise FeatureError(
                f"{feature.name}: found parents {feature.junctions}, expected two neighbours"
            )
