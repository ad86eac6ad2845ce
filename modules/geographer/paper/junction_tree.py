"""The paper's network solved by pyAgrum's junction tree, and by pgmpy where that is able to.

The paper used Jensen's variation of Lauritzen and Spiegelhalter's algorithm; pyAgrum's lazy
propagation works in the same tree of cliques.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from modules.geographer.paper.belief import HypothesisBelief, contradiction, scaled_likelihood
from modules.geographer.paper.errors import NetworksMissingError
from modules.geographer.paper.network import MAP, NO_READINGS, PaperNetwork, declare

if TYPE_CHECKING:
    from pgmpy.models import DiscreteBayesianNetwork

Floats = NDArray[np.float64]


def to_agrum(net: DiscreteBayesianNetwork) -> Any:
    """A pgmpy network as a `pyagrum.BayesNet`, table by table, with the states' names.

    Raises NetworksMissingError without pyAgrum.
    """
    agrum = _agrum()
    converted = agrum.BayesNet()
    tables = net.get_cpds()
    for table in tables:
        states = table.state_names[table.variable]
        converted.add(agrum.LabelizedVariable(table.variable, table.variable, list(states)))
    for table in tables:
        for parent in table.variables[1:]:
            converted.addArc(parent, table.variable)
        of_node = converted.cpt(table.variable)
        # pyAgrum's arrays have the node last and its parents in the reverse order of `names`
        order = [table.variables.index(name) for name in reversed(of_node.names)]
        of_node[:] = np.ascontiguousarray(np.transpose(table.values, order))
    return converted


class JunctionTree:
    """A network in pyAgrum, made once; each :meth:`update` takes all the evidence there is.

    >>> tree = JunctionTree(PaperNetwork(hypotheses))       # 4x4: hypotheses of n maps and NOTA
    >>> belief = tree.update(junction_likelihood)           # (4, 4, 16), soft or certain
    >>> belief.states, belief.junctions, tree.largest_clique

    Raises NetworksMissingError.
    """

    def __init__(self, network: PaperNetwork) -> None:
        self.network = network
        self._inference: Any = _agrum().LazyPropagation(self._net)

    @cached_property
    def _net(self) -> Any:
        return to_agrum(declare(self.network))

    def update(
        self,
        junction_likelihood: ArrayLike | None = None,
        readings: Mapping[str, int] = NO_READINGS,
    ) -> HypothesisBelief:
        """The belief given lambda(J) (rows, columns, 16) and the class read for each feature.

        A junction of which only one type is left is instantiated: it leaves the cliques.
        Raises EvidenceError, ContradictedHypothesesError.
        """
        network = self.network
        grid = network.hypotheses.grid
        evidence: dict[str, Any] = dict(network.reading_evidence(readings))
        log_scale, scaled = 0.0, np.ones((0, 0))
        if junction_likelihood is not None:
            scaled, log_scale = scaled_likelihood(grid, junction_likelihood)
        for node, row in network.junction_evidence(junction_likelihood).items():
            if not row.any():
                raise contradiction(grid, scaled)
            certain = np.count_nonzero(row) == 1
            evidence[node] = int(row.argmax()) if certain else row.tolist()
        self._inference.setEvidence(evidence)
        try:
            self._inference.makeInference()
        except _agrum().IncompatibleEvidence as error:
            raise contradiction(grid, scaled) from error
        nodes = [network.junction_name(v) for v in range(grid.intersections)]
        found = [self._inference.posterior(node).toarray() for node in (MAP, *nodes)]
        log = math.log(self._inference.evidenceProbability()) + log_scale
        return network.belief(found[0], found[1:], log)

    @property
    def largest_clique(self) -> int:
        """Cells of the largest clique in the tree of the last update."""
        tree, net = self._inference.junctionTree(), self._net
        sizes: list[int] = [
            math.prod(net.variable(node).domainSize() for node in tree.clique(clique))
            for clique in tree.nodes()
        ]
        return max(sizes)


def pgmpy_posterior(
    network: PaperNetwork,
    net: DiscreteBayesianNetwork,
    junction_likelihood: ArrayLike,
) -> HypothesisBelief:
    """The belief by pgmpy's variable elimination: an oracle, one query a node.

    `net` is `declare(network)`, made once by the caller, since that takes longer than a query.
    pgmpy's own junction tree runs out of memory on 4x4. The log of the evidence is NaN: pgmpy
    does not say it. Raises EvidenceError.
    """
    from pgmpy.factors.discrete import TabularCPD
    from pgmpy.inference import VariableElimination

    grid = network.hypotheses.grid
    virtual = [
        TabularCPD(
            node,
            len(row),
            (row / row.sum())[:, None],
            state_names={node: net.get_cpds(node).state_names[node]},
        )
        for node, row in network.junction_evidence(junction_likelihood).items()
    ]
    nodes = [MAP, *(network.junction_name(v) for v in range(grid.intersections))]
    found = [
        VariableElimination(net)
        .query([node], virtual_evidence=virtual or None, show_progress=False)
        .values
        for node in nodes
    ]
    return network.belief(found[0], found[1:], math.nan)


def _agrum() -> Any:
    try:
        import pyagrum
    except ImportError as error:
        raise NetworksMissingError("pyagrum") from error
    return pyagrum
