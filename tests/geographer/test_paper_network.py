"""The paper's network: three ways to the same belief, and what is declared is what is meant."""

from __future__ import annotations

import sys
from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pyagrum
import pytest
from numpy.typing import NDArray

from bus.features import USUAL
from bus.grid import DIRECTIONS, EAST, JUNCTION_TYPES, NORTH, SOUTH, WEST, Grid
from modules.classifier.geometry import enterable, presence_table
from modules.classifier.likelihood import Reading, junction_likelihood
from modules.classifier.sensor_model import EVIDENCE_CLASSES, load_sensor_model
from modules.geographer import ConnectedMaps, EvidenceError
from modules.geographer.paper import (
    ContradictedHypothesesError,
    Feature,
    FeatureError,
    HypothesesError,
    HypothesisBelief,
    HypothesisSet,
    NetworksMissingError,
    PaperNetwork,
    corridor_features,
    declare,
    direct_belief,
    draw_hypotheses,
    junction_features,
)
from modules.geographer.paper.junction_tree import JunctionTree, pgmpy_posterior
from modules.geographer.paper.triangulation import largest_clique
from tests.geographer.every_map import all_maps

Floats = NDArray[np.float64]
EXACT = 1e-9
agrum: Any = pyagrum  # its functions are not typed
SEEN = np.array([[0.9, 0.1], [0.2, 0.8]])


def hypotheses(columns: int, rows: int, states: int, seed: int = 1) -> HypothesisSet:
    maps = ConnectedMaps(columns, rows)
    belief = maps.posterior(np.ones((rows, columns, JUNCTION_TYPES)))
    return draw_hypotheses(belief, states, np.random.default_rng(seed))


def some_likelihood(grid: Grid, seed: int) -> Floats:
    """Soft everywhere but at one junction that is certain and one of which nothing is known."""
    likelihood = np.random.default_rng(seed).random((grid.rows, grid.columns, JUNCTION_TYPES)) * 3
    likelihood[0, 0] = 0.0
    likelihood[0, 0, EAST] = 0.7
    likelihood[-1, -1] = 1.0
    return likelihood


def assert_equal(found: HypothesisBelief, expected: HypothesisBelief) -> None:
    assert np.abs(found.states - expected.states).max() < EXACT
    assert np.abs(found.junctions - expected.junctions).max() < EXACT
    assert np.isnan(found.log_evidence) or found.log_evidence == pytest.approx(
        expected.log_evidence, abs=EXACT
    )


@pytest.mark.parametrize(("columns", "rows", "states"), [(3, 2, 4), (4, 4, 10), (4, 4, 30)])
def test_the_direct_belief_is_the_junction_tree_s(columns: int, rows: int, states: int) -> None:
    chosen = hypotheses(columns, rows, states)
    assert chosen.states == states
    tree = JunctionTree(PaperNetwork(chosen))
    for seed in range(3):
        likelihood = some_likelihood(chosen.grid, seed)
        assert_equal(tree.update(likelihood), direct_belief(chosen, likelihood))


def test_the_direct_belief_is_pgmpy_s() -> None:
    network = PaperNetwork(hypotheses(4, 4, 10))
    likelihood = some_likelihood(network.hypotheses.grid, 1)
    found = pgmpy_posterior(network, declare(network), likelihood)
    assert_equal(found, direct_belief(network.hypotheses, likelihood))


def test_readings_of_the_calibrated_detectors_come_through_as_the_classifier_s_lambda() -> None:
    chosen, place, heading = hypotheses(3, 3, 8), 4, EAST
    # In the paper's network readings are independent given J: no visit goes astray, and no two of
    # these readings are of corners beside the same way.
    model = replace(load_sensor_model(), astray=0.0)
    present = presence_table()[DIRECTIONS.index(heading)].reshape(JUNCTION_TYPES, -1)
    probability = model.probability.reshape(-1, 2, EVIDENCE_CLASSES)
    names = [str(detector) for detector in range(USUAL.detectors)]
    features = junction_features(place, names, present, probability)
    readings = [Reading(0, 3), Reading(8 + 2, 0), Reading(16 + 6, 2)]
    likelihood = np.ones((3, 3, JUNCTION_TYPES))
    likelihood[1, 1] = junction_likelihood(readings, heading, model)
    # that the robot came by the corridor behind it is evidence about J, not a reading
    came = np.ones((3, 3, JUNCTION_TYPES))
    came[1, 1] = enterable(heading)

    network = PaperNetwork(chosen, tuple(features))
    assert network.singly_connected
    found = JunctionTree(network).update(
        came, {f"{place}_{reading.detector}": reading.evidence for reading in readings}
    )
    assert_equal(found, direct_belief(chosen, likelihood))


def by_enumeration(network: PaperNetwork, likelihood: Floats, read: dict[str, int]) -> Any:
    """Pr(H) and Pr(J) from the joint distribution, state by state."""
    chosen = network.hypotheses
    grid = chosen.grid
    rows = likelihood.reshape(-1, JUNCTION_TYPES)
    tables = [chosen.junction_given_state(v) for v in range(grid.intersections)]
    states = np.zeros(chosen.states)
    junctions = np.zeros((grid.intersections, JUNCTION_TYPES))
    for types in product(*(chosen.types_at(v) for v in range(grid.intersections))):
        weight = chosen.prior.copy()
        for v, t in enumerate(types):
            weight *= tables[v][:, t] * rows[v, t]
        for feature in network.features:
            if feature.name in read:
                holds = feature.present[tuple(types[v] for v in feature.junctions)]
                of_class = feature.readings[:, read[feature.name]]
                weight *= (1 - holds) * of_class[0] + holds * of_class[1]
        states += weight
        for v, t in enumerate(types):
            junctions[v, t] += weight.sum()
    total = states.sum()
    shape = (grid.rows, grid.columns, JUNCTION_TYPES)
    return HypothesisBelief(states / total, junctions.reshape(shape) / total, float(np.log(total)))


@pytest.mark.parametrize("seed", [1, 2])
def test_the_multiply_connected_network_is_the_joint_distribution(seed: int) -> None:
    chosen = hypotheses(3, 2, 6, seed)
    network = PaperNetwork(chosen, tuple(corridor_features(chosen.grid, SEEN)))
    assert not network.singly_connected
    likelihood = some_likelihood(chosen.grid, seed)
    read = {"corridor_1": 1, "corridor_2": 0, "corridor_6": 1}
    found = JunctionTree(network).update(likelihood, read)
    assert_equal(found, by_enumeration(network, likelihood, read))


def test_a_corridor_opens_at_both_its_ends_or_is_none() -> None:
    for feature in corridor_features(Grid(2, 2), SEEN):
        south_west, north_east = feature.junctions
        here, there = (EAST, WEST) if north_east - south_west == 1 else (NORTH, SOUTH)
        for a, b in product(range(JUNCTION_TYPES), repeat=2):
            assert feature.present[a, b] == bool(a & here and b & there)


def test_a_feature_of_two_junctions_tells_of_the_neighbour() -> None:
    chosen = hypotheses(2, 2, 3)
    network = PaperNetwork(chosen, tuple(corridor_features(chosen.grid, SEEN)))
    before = JunctionTree(network).update()
    after = JunctionTree(network).update(readings={"corridor_0": 1})
    east = [t for t in range(JUNCTION_TYPES) if t & EAST]
    assert after.junctions[0, 0, east].sum() > before.junctions[0, 0, east].sum()
    assert after.junctions[0, 1].tolist() != before.junctions[0, 1].tolist()


def test_a_set_of_all_maps_has_the_exact_belief() -> None:
    maps = all_maps(3, 2)
    likelihood = some_likelihood(Grid(3, 2), 3)
    found = direct_belief(HypothesisSet(Grid(3, 2), maps, exhaustive=True), likelihood)
    exact = ConnectedMaps(3, 2).posterior(likelihood)
    assert np.abs(found.junctions - exact.junctions).max() < EXACT
    assert found.nota == 0.0
    assert found.log_evidence == pytest.approx(exact.log_evidence, abs=EXACT)


def test_evidence_may_be_as_small_as_floats_get() -> None:
    chosen = hypotheses(4, 4, 10)
    likelihood = some_likelihood(chosen.grid, 1)
    tiny = direct_belief(chosen, likelihood * 1e-300)
    plain = direct_belief(chosen, likelihood)
    assert np.abs(tiny.states - plain.states).max() < EXACT
    assert tiny.log_evidence == pytest.approx(plain.log_evidence + 16 * np.log(1e-300))


def test_the_declared_network_is_exported_and_read_by_another_library(tmp_path: Path) -> None:
    chosen = hypotheses(2, 2, 4)
    network = PaperNetwork(chosen, tuple(corridor_features(chosen.grid, SEEN)))
    file = tmp_path / "huey.bif"
    declare(network).save(str(file), filetype="bif")
    inference = agrum.LazyPropagation(agrum.loadBN(str(file)))
    inference.setEvidence({"S_corridor_1": "class_1", "J_0_0": "NE"})
    inference.makeInference()
    likelihood = np.ones((2, 2, JUNCTION_TYPES))
    likelihood[0, 0] = 0.0
    likelihood[0, 0, 3] = 1.0
    expected = by_enumeration(network, likelihood, {"corridor_1": 1})
    assert np.abs(inference.posterior("H").toarray() - expected.states).max() < EXACT


def test_pyagrum_s_largest_clique_is_the_one_reckoned_beforehand() -> None:
    chosen = hypotheses(4, 4, 10)
    network = PaperNetwork(chosen, tuple(corridor_features(chosen.grid, SEEN)))
    tree = JunctionTree(network)
    for instantiated in ([0, 1, 5, 4], [5, 6, 10, 9, 8, 12], list(range(10))):
        likelihood = np.ones((16, JUNCTION_TYPES))
        likelihood[instantiated] = 0.0
        likelihood[instantiated, chosen.types[0, instantiated]] = 1.0
        tree.update(likelihood.reshape(4, 4, JUNCTION_TYPES))
        assert tree.largest_clique == largest_clique(network, instantiated)


def test_the_singly_connected_network_costs_a_junction_times_h() -> None:
    assert largest_clique(PaperNetwork(hypotheses(4, 4, 30)), []) == 30 * 16


def test_sets_of_hypotheses_are_checked() -> None:
    grid = Grid(2, 2)
    for maps, words in (
        ([[1, 0, 0]], "shape"),
        (np.empty((0, 4)), "found none"),
        ([[1, 0, 0, 2]], "found an entry 2"),
        ([[1, 0, 0, 0], [1, 0, 0, 0]], "maps 0 and 1 are the same"),
        ([[1, 0, 1, 0], [1, 1, 0, 0]], "map 1"),
        ([[0, 0, 0, 0]], "map 0"),
    ):
        with pytest.raises(HypothesesError, match=words):
            HypothesisSet(grid, np.array(maps, dtype=np.uint8))


def test_all_connected_maps_and_no_other_pass_the_check() -> None:
    grid = Grid(3, 2)
    connected = {m.tobytes() for m in all_maps(3, 2)}
    HypothesisSet(grid, all_maps(3, 2))
    for corridors in product((0, 1), repeat=grid.corridors):
        candidate = np.array([corridors], dtype=np.uint8)
        if candidate.tobytes() not in connected:
            with pytest.raises(HypothesesError, match="map 0"):
                HypothesisSet(grid, candidate)


def test_features_are_checked() -> None:
    chosen = hypotheses(3, 2, 3)
    good = corridor_features(chosen.grid, SEEN)[0]
    both = np.zeros((JUNCTION_TYPES, JUNCTION_TYPES))
    with pytest.raises(FeatureError, match="two neighbours"):
        PaperNetwork(chosen, (Feature("far", (0, 5), both, SEEN),))
    with pytest.raises(FeatureError, match="two features"):
        PaperNetwork(chosen, (good, corridor_features(chosen.grid, SEEN)[0]))
    with pytest.raises(FeatureError, match=r"0\.\.5"):
        PaperNetwork(chosen, (Feature("off", (6,), both[0], SEEN),))
    with pytest.raises(FeatureError, match="shape"):
        Feature("flat", (0, 1), both[0], SEEN)
    with pytest.raises(FeatureError, match="one or two"):
        Feature("three", (0, 1, 2), both, SEEN)
    with pytest.raises(FeatureError, match="sum to 1"):
        Feature("leaky", (0,), both[0], SEEN / 2)
    with pytest.raises(FeatureError, match=r"0\.\.1"):
        Feature("sure", (0,), both[0] + 2, SEEN)
    with pytest.raises(FeatureError, match="readings has shape"):
        Feature("thin", (0,), both[0], SEEN[:1])


def test_evidence_is_checked() -> None:
    chosen = hypotheses(2, 2, 3)
    tree = JunctionTree(PaperNetwork(chosen, tuple(corridor_features(chosen.grid, SEEN))))
    with pytest.raises(EvidenceError, match="shape"):
        direct_belief(chosen, np.ones((2, 2, 15)))
    with pytest.raises(EvidenceError, match="nan"):
        direct_belief(chosen, np.full((2, 2, JUNCTION_TYPES), np.nan))
    with pytest.raises(EvidenceError, match="'door'"):
        tree.update(readings={"door": 1})
    with pytest.raises(EvidenceError, match=r"found class 2, expected 0\.\.1"):
        tree.update(readings={"corridor_0": 2})


def test_evidence_against_every_state_names_the_junctions() -> None:
    chosen = hypotheses(2, 2, 3)
    impossible = np.ones((2, 2, JUNCTION_TYPES))
    impossible[1, 0] = 0.0
    for solve in (JunctionTree(PaperNetwork(chosen)).update, lambda e: direct_belief(chosen, e)):
        with pytest.raises(ContradictedHypothesesError, match=r"\[0,1\]") as caught:
            solve(impossible)
        assert caught.value.junctions == [(0, 1)]


def test_a_missing_library_is_said_to_be_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    network = PaperNetwork(hypotheses(2, 2, 3))
    monkeypatch.setitem(sys.modules, "pyagrum", None)
    with pytest.raises(NetworksMissingError, match=r"pyagrum is not installed.*networks"):
        JunctionTree(network)
    monkeypatch.setitem(sys.modules, "pgmpy.models", None)
    with pytest.raises(NetworksMissingError, match="pgmpy is not installed"):
        declare(network)
