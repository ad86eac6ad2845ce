"""A set of hypotheses that is replaced when none of them is right any more (paper, section 3)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from bus.grid import JUNCTION_TYPES
from modules.geographer.connected_maps import ConnectedMaps
from modules.geographer.paper.belief import HypothesisBelief, direct_belief
from modules.geographer.paper.drawing import draw_hypotheses
from modules.geographer.paper.errors import ContradictedHypothesesError
from modules.geographer.paper.hypotheses import HypothesisSet


@dataclass(frozen=True, eq=False)
class Revision:
    """The hypotheses after an update, their belief, and whether they had to be replaced."""

    hypotheses: HypothesisSet
    belief: HypothesisBelief
    replaced: bool


def first_set(
    all_maps: ConnectedMaps,
    states: int,
    rng: np.random.Generator,
    corridor_count_weights: ArrayLike | None = None,
) -> HypothesisSet:
    """The hypotheses before anything was observed; arguments as in :func:`revise`."""
    nothing = np.ones((all_maps.grid.rows, all_maps.grid.columns, JUNCTION_TYPES))
    return _new_set(nothing, all_maps, states, rng, corridor_count_weights)


def revise(
    hypotheses: HypothesisSet,
    junction_likelihood: ArrayLike,
    all_maps: ConnectedMaps,
    states: int,
    rng: np.random.Generator,
    corridor_count_weights: ArrayLike | None = None,
) -> Revision:
    """The belief given all the evidence, with a new set of hypotheses where NOTA exceeds all maps.

    The new set has up to `states` states and is exhaustive when it can be; else it prefers maps by
    `corridor_count_weights` (modules/geographer/density.py makes some; none is no preference).
    Later evidence may make NOTA exceed it again, and the next call draws once more: "the
    procedure is repeated until an exhaustive set is possible". One set is drawn a call: evidence
    that fits independent junctions better than any connected map leaves NOTA on top, visibly.

    Raises EvidenceError, and ContradictoryEvidenceError where no connected map is possible.
    """
    belief = _belief_or_none(hypotheses, junction_likelihood)
    if belief is not None and not belief.nota_exceeds:
        return Revision(hypotheses, belief, replaced=False)
    new = _new_set(junction_likelihood, all_maps, states, rng, corridor_count_weights)
    return Revision(new, direct_belief(new, junction_likelihood), replaced=True)


def _new_set(
    junction_likelihood: ArrayLike,
    all_maps: ConnectedMaps,
    states: int,
    rng: np.random.Generator,
    corridor_count_weights: ArrayLike | None,
) -> HypothesisSet:
    """All possible maps if they fit, whatever their density; else some of the preferred ones."""
    found = draw_hypotheses(all_maps.posterior(junction_likelihood), states, rng)
    if found.exhaustive or corridor_count_weights is None:
        return found
    preferring = all_maps.posterior(
        junction_likelihood, corridor_count_weights=corridor_count_weights
    )
    return draw_hypotheses(preferring, states, rng)


def _belief_or_none(
    hypotheses: HypothesisSet, junction_likelihood: ArrayLike
) -> HypothesisBelief | None:
    """None where even NOTA is impossible: it was ruled out as the set was exhaustive."""
    try:
        return direct_belief(hypotheses, junction_likelihood)
    except ContradictedHypothesesError:
        return None
