"""What is believed where the robot may be in several places: a mixture over the registrations.

Each registration has its own exact belief over all connected maps. Its weight is its prior times
the evidence that this belief returns; all that is said of the map, or of the junction ahead, is the
average by these weights.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bus.messages import MapBelief as Said
from bus.messages import Registrations
from modules.geographer.errors import ContradictoryEvidenceError
from modules.geographer.map_belief import MapBelief
from modules.geographer.registration import Registration, weights
from modules.geographer.sampling import WeightedMaps

Floats = NDArray[np.float64]

GONE = 1e-30
"""A registration that is less probable is dropped for good. What was recalled may be wrong in many
places, and the right registration must come through that."""

TOLD = 1e-10
"""One that is less probable is kept, but not told of: far less than any decision notices."""


@dataclass(frozen=True, eq=False)
class Believed:
    """A registration, its probability, and the belief about the map if it is the right one."""

    at: Registration
    belief: MapBelief
    weight: float
    log_weight: float

    @property
    def ahead(self) -> Floats:
        """P(type of the junction ahead), (16,)."""
        x, y = self.at.record.grid.place(self.at.ahead)
        types: Floats = self.belief.junctions[y, x]
        return types


def weighed(
    registrations: Sequence[Registration], believe: Callable[[Registration], MapBelief]
) -> tuple[Believed, ...]:
    """The registrations that the evidence leaves, with their weights.

    One alone has the weight 1. Raises ContradictoryEvidenceError where no map fits any of them.
    """
    found = [(at, belief) for at in registrations if (belief := _possible(at, believe)) is not None]
    if not found:
        believe(registrations[0])  # says what contradicts what
    prior = np.array([at.log_prior for at, _ in found])
    evidence = np.array([at.record.log_scale + belief.log_evidence for at, belief in found])
    shares = weights(prior, evidence)
    kept = shares >= GONE
    logs = prior + evidence
    shares = shares[kept] / shares[kept].sum()
    return tuple(
        Believed(*found[k], float(share), float(logs[k]))
        for k, share in zip(np.flatnonzero(kept), shares, strict=True)
    )


def _possible(at: Registration, believe: Callable[[Registration], MapBelief]) -> MapBelief | None:
    try:
        return believe(at)
    except ContradictoryEvidenceError:
        return None


def told(believed: Sequence[Believed]) -> tuple[Believed, ...]:
    """The registrations worth telling of, with weights that sum to one."""
    worth = [one for one in believed if one.weight >= TOLD]
    total = sum(one.weight for one in worth)
    return tuple(replace(one, weight=one.weight / total) for one in worth)


def likeliest(believed: Sequence[Believed]) -> Believed:
    """The most probable registration; the first of equals."""
    return max(believed, key=lambda one: one.weight)


def ahead(believed: Sequence[Believed]) -> Floats:
    """P(type of the junction ahead), wherever that is: (16,)."""
    return _mean(believed, [one.ahead for one in believed])


def map_belief(
    visit: int, heading: int, believed: Sequence[Believed], maps: Sequence[WeightedMaps]
) -> Said:
    """What is said of the map: of one registration, or averaged over several."""
    best = likeliest(believed)
    x, y = best.at.record.grid.place(best.at.ahead)
    every = np.concatenate([some.maps for some in maps])
    return Said(
        visit,
        x,
        y,
        heading,
        _mean(believed, [one.belief.junctions for one in believed]),
        _mean(believed, [one.belief.corridors for one in believed]),
        best.at.roads.corridor_s(),
        _log_evidence(believed),
        _entropy(believed),
        every,
        np.concatenate([one.weight * w.weights for one, w in zip(believed, maps, strict=True)]),
        maps[0].log_probability if len(maps) == 1 else _log_probability(believed, every),
    )


def registrations(
    visit: int, heading: int, believed: Sequence[Believed], maps: Sequence[WeightedMaps]
) -> Registrations:
    """What is said of where the robot may be."""
    return Registrations(
        visit,
        heading,
        np.array([one.at.ahead for one in believed], np.int64),
        np.array([one.weight for one in believed]),
        np.array([one.ahead for one in believed]),
        np.array([one.belief.corridors for one in believed]),
        np.array([one.at.roads.corridor_s() for one in believed]),
        np.repeat(np.arange(len(maps), dtype=np.int64), [len(some.maps) for some in maps]),
        np.concatenate([some.maps for some in maps]),
        np.concatenate([some.weights for some in maps]),
        np.concatenate([some.log_probability for some in maps]),
    )


def _mean(believed: Sequence[Believed], each: Sequence[Floats]) -> Floats:
    total = believed[0].weight * each[0]
    for one, values in zip(believed[1:], each[1:], strict=True):
        total = total + one.weight * values
    return total


def _log_evidence(believed: Sequence[Believed]) -> float:
    """Of all that was observed; of one registration alone, of its record as it is scaled."""
    if len(believed) == 1:
        return believed[0].belief.log_evidence
    return float(np.logaddexp.reduce([one.log_weight for one in believed]))


def _entropy(believed: Sequence[Believed]) -> float:
    """Of place and map together, in nats."""
    if len(believed) == 1:
        return believed[0].belief.entropy
    return sum(one.weight * (one.belief.entropy - float(np.log(one.weight))) for one in believed)


def _log_probability(believed: Sequence[Believed], maps: NDArray[np.uint8]) -> Floats:
    """Log P(map), wherever the robot is: (maps,)."""
    logs = [np.log(one.weight) + one.belief.log_probability(maps) for one in believed]
    found: Floats = np.logaddexp.reduce(logs)
    return found
