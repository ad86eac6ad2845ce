"""The network H -> J_{x,y} -> X -> S of the paper's Figure 2, declared with pgmpy.

Declared, it can be checked, drawn and exported; it is solved by pyAgrum (agrum.py) or, where it
is singly connected and all evidence is lambda(J), directly (belief.py).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bus.grid import JUNCTION_TYPES, type_name
from modules.geographer.errors import EvidenceError
from modules.geographer.paper.belief import HypothesisBelief, scaled_likelihood
from modules.geographer.paper.errors import NetworksMissingError
from modules.geographer.paper.features import Feature, check_features
from modules.geographer.paper.hypotheses import HypothesisSet

if TYPE_CHECKING:
    from pgmpy.models import DiscreteBayesianNetwork

Floats = NDArray[np.float64]
MAP = "H"
NO_READINGS: Mapping[str, int] = MappingProxyType({})


@dataclass(frozen=True, eq=False)
class PaperNetwork:
    """The hypotheses and the features that can be sensed.

    Singly connected where no feature has two parents. Raises FeatureError.
    """

    hypotheses: HypothesisSet
    features: tuple[Feature, ...] = ()

    def __post_init__(self) -> None:
        check_features(self.hypotheses.grid, self.features)

    @property
    def singly_connected(self) -> bool:
        """Whether at most one path joins any two nodes, so that cost is linear in |H|."""
        return all(len(feature.junctions) == 1 for feature in self.features)

    def junction_name(self, intersection: int) -> str:
        """The node J of an intersection: J_x_y."""
        x, y = self.hypotheses.grid.place(intersection)
        return f"J_{x}_{y}"

    def junction_evidence(self, junction_likelihood: ArrayLike | None) -> dict[str, Floats]:
        """The lambda over the states of each J that was read, its largest entry 1.

        Raises EvidenceError.
        """
        if junction_likelihood is None:
            return {}
        rows, _ = scaled_likelihood(self.hypotheses.grid, junction_likelihood)
        found = {}
        for v, row in enumerate(rows):
            given = row[self.hypotheses.types_at(v)]
            if given.min() < 1.0:
                found[self.junction_name(v)] = given
        return found

    def reading_evidence(self, readings: Mapping[str, int]) -> dict[str, int]:
        """The class of each S that was read, by node. Raises EvidenceError."""
        classes = {feature.name: feature.classes for feature in self.features}
        for name, evidence in readings.items():
            if name not in classes:
                raise EvidenceError(f"readings: found {name!r}, which no feature is called")
            if not 0 <= evidence < classes[name]:
                raise EvidenceError(
                    f"readings[{name!r}]: found class {evidence}, expected 0..{classes[name] - 1}"
                )
        return {f"S_{name}": evidence for name, evidence in readings.items()}

    def belief(self, states: Floats, by_junction: list[Floats], log: float) -> HypothesisBelief:
        """What a solver found, with the junctions' states put back among all 16 types."""
        grid = self.hypotheses.grid
        junctions = np.zeros((grid.intersections, JUNCTION_TYPES))
        for v, probabilities in enumerate(by_junction):
            junctions[v, self.hypotheses.types_at(v)] = probabilities
        return HypothesisBelief(states, junctions.reshape(grid.rows, grid.columns, -1), log)


def declare(network: PaperNetwork) -> DiscreteBayesianNetwork:
    """The network in pgmpy, checked: a node H, one J an intersection, an X and an S a feature.

    `declare(network).save("huey.bif", filetype="bif")` exports it, `to_graphviz()` draws it.
    Raises NetworksMissingError without pgmpy, ValueError from its `check_model` where tables
    do not fit together.
    """
    model, table = _pgmpy()
    hypotheses = network.hypotheses
    maps = [f"map_{number}" for number in range(len(hypotheses.maps))]
    names = {MAP: [*maps, "NOTA"]}
    net = model()
    net.add_node(MAP)
    net.add_cpds(table(MAP, hypotheses.states, hypotheses.prior[:, None], state_names=names))
    for v in range(hypotheses.grid.intersections):
        node, types = network.junction_name(v), hypotheses.types_at(v)
        names[node] = [type_name(int(t)) if t else "none" for t in types]  # BIF knows no "-"
        net.add_edge(MAP, node)
        given = hypotheses.junction_given_state(v)[:, types].T
        net.add_cpds(_table(table, names, node, given, (MAP,)))
    for feature in network.features:
        _declare_feature(net, table, network, feature, names)
    net.check_model()
    return net


def _declare_feature(
    net: Any, table: Any, network: PaperNetwork, feature: Feature, names: dict[str, list[str]]
) -> None:
    x, s = f"X_{feature.name}", f"S_{feature.name}"
    parents = tuple(network.junction_name(v) for v in feature.junctions)
    fitting = [network.hypotheses.types_at(v) for v in feature.junctions]
    holds = feature.present[np.ix_(*fitting)].reshape(-1)
    names |= {x: ["absent", "present"], s: [f"class_{c}" for c in range(feature.classes)]}
    net.add_edges_from([*((parent, x) for parent in parents), (x, s)])
    net.add_cpds(
        _table(table, names, x, np.array([1.0 - holds, holds]), parents),
        _table(table, names, s, feature.readings.T, (x,)),
    )


def _table(
    table: Any, names: dict[str, list[str]], node: str, values: Floats, parents: tuple[str, ...]
) -> Any:
    """Pr(node | parents), the parents' states in columns, the last parent's running fastest."""
    own = {name: names[name] for name in (node, *parents)}
    sizes = [len(names[parent]) for parent in parents]
    return table(node, len(names[node]), values, list(parents), sizes, state_names=own)


def _pgmpy() -> tuple[Any, Any]:
    try:
        from pgmpy.factors.discrete import TabularCPD
        from pgmpy.models import DiscreteBayesianNetwork  # here, since this import takes 3 s
    except ImportError as error:
        raise NetworksMissingError("pgmpy") from error
    return DiscreteBayesianNetwork, TabularCPD
