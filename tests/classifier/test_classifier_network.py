"""The compiled tables say what the declared network J -> X -> S says, by two libraries."""

from pathlib import Path
from typing import Any

import numpy as np
import pyagrum
import pytest
from pgmpy.inference import VariableElimination
from pgmpy.models import DiscreteBayesianNetwork
from pgmpy.readwrite import BIFReader

from bus.features import USUAL, Wedges
from bus.grid import DIRECTIONS
from modules.classifier.geometry import enterable
from modules.classifier.likelihood import Reading, junction_likelihood
from modules.classifier.network import (
    JUNCTION,
    came_by,
    declare_network,
    export_network,
    reading_name,
)
from modules.classifier.sensor_model import SensorModel, shape_of

EXACT = 1e-9
agrum: Any = pyagrum  # its functions are not typed


def _case(
    seed: int, wedges: Wedges = USUAL
) -> tuple[SensorModel, np.ndarray[Any, Any], int, list[Reading]]:
    rng = np.random.default_rng(seed)
    shape = shape_of(wedges)
    model = SensorModel(rng.integers(0, 300, shape), np.full(shape[:2], 40.0), {}, "a test")
    prior = rng.dirichlet(np.ones(16))
    detectors = rng.permutation(wedges.detectors)[: 3 + 4 * seed]
    readings = [Reading(int(d), int(rng.integers(4))) for d in detectors]
    return model, prior, int(rng.choice(DIRECTIONS)), readings


def _evidence(readings: list[Reading], wedges: Wedges = USUAL) -> dict[str, int]:
    said = {reading_name(r.detector, wedges): r.evidence for r in readings}
    return {came_by(wedges): 1} | said


def _agrum(network: DiscreteBayesianNetwork) -> Any:
    """The same network in the other library, table by table."""
    net = agrum.BayesNet()
    for cpd in network.get_cpds():
        net.add(agrum.LabelizedVariable(cpd.variable, "", cpd.variable_card))
    for cpd in network.get_cpds():
        for parent in cpd.variables[1:]:
            net.addArc(parent, cpd.variable)
        net.cpt(cpd.variable)[:] = np.ascontiguousarray(cpd.values.T)
    return net


@pytest.mark.parametrize(("seed", "count"), [(0, 8), (1, 8), (2, 8), (3, 4), (4, 12)])
def test_posterior_equals_both_libraries(seed: int, count: int) -> None:
    wedges = Wedges(count)
    model, prior, heading, readings = _case(seed, wedges)
    evidence = _evidence(readings, wedges)
    joint = prior * junction_likelihood(readings, heading, model)
    network = declare_network(prior, heading, model)

    found = VariableElimination(network).query([JUNCTION], evidence=evidence, show_progress=False)
    assert np.abs(found.values - joint / joint.sum()).max() < EXACT

    inference = agrum.LazyPropagation(_agrum(network))
    inference.setEvidence(evidence)
    inference.makeInference()
    assert np.abs(inference.posterior(JUNCTION).toarray() - joint / joint.sum()).max() < EXACT
    assert inference.evidenceProbability() == pytest.approx(joint.sum(), rel=EXACT)


def test_likelihood_of_each_type_is_a_probability_not_a_scaled_one() -> None:
    model, _, heading, readings = _case(1)
    uniform = np.full(16, 1 / 16)
    net = _agrum(declare_network(uniform, heading, model))
    found = junction_likelihood(readings, heading, model)
    for j in np.flatnonzero(enterable(heading)).tolist():
        inference = agrum.LazyPropagation(net)
        inference.setEvidence(_evidence(readings) | {JUNCTION: j})
        inference.makeInference()
        # P(readings, J=j) = P(readings|J=j) / 16
        assert 16 * inference.evidenceProbability() == pytest.approx(found[j], rel=EXACT)


SINGLE = 1e-6
"""pyAgrum reads the numbers of a BIF file in single precision."""


def test_the_exported_network_says_the_same_in_another_library(tmp_path: Path) -> None:
    model, prior, heading, readings = _case(1)
    path = tmp_path / "junction.bif"
    export_network(path, prior, heading, model)
    net = agrum.loadBN(str(path))
    # J, three doorways, whether the visit has gone astray, and X and S of every detector.
    assert net.size() == 5 + 2 * USUAL.detectors
    inference = agrum.LazyPropagation(net)
    inference.setEvidence({name: str(state) for name, state in _evidence(readings).items()})
    inference.makeInference()
    joint = prior * junction_likelihood(readings, heading, model)
    assert np.abs(inference.posterior(JUNCTION).toarray() - joint / joint.sum()).max() < SINGLE

    read = BIFReader(str(path)).get_model()
    for cpd in declare_network(prior, heading, model).get_cpds():
        assert np.array_equal(read.get_cpds(cpd.variable).values, cpd.values)
