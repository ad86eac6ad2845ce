"""The classifier's Bayes net J -> X_{f,w} -> S_{f,w}, declared (paper, section 3).

The running code multiplies compiled tables; this declaration is what they must agree with.
That the robot came by the corridor behind is hard evidence: X of the opening behind. Beside the
paper's nodes there is one for a doorway on each side, a parent of the features at its corners, and
one for a visit gone astray, a parent of all readings.
"""

from __future__ import annotations

from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from bus.features import AHEAD, FEATURES, LEFT, OPENING, RIGHT, USUAL, Wedges
from bus.grid import JUNCTION_TYPES, LEFT_OF, RIGHT_OF
from modules.classifier.geometry import DOORWAY_RATE, heading_number, presence
from modules.classifier.sensor_model import EVIDENCE_CLASSES, SensorModel

if TYPE_CHECKING:
    from pgmpy.models import DiscreteBayesianNetwork

JUNCTION = "J"
ASTRAY = "astray"
SIDES = {AHEAD: "ahead", LEFT: "left", RIGHT: "right"}


def feature_name(detector: int, wedges: Wedges = USUAL) -> str:
    """The node X_{f,w} that a detector tests. Raises WedgeError."""
    feature, wedge = wedges.parts(detector)
    return f"X_{FEATURES[feature]}_{wedge}"


def reading_name(detector: int, wedges: Wedges = USUAL) -> str:
    """The node S_{f,w} of a detector's evidence class. Raises WedgeError."""
    return feature_name(detector, wedges).replace("X", "S", 1)


def came_by(wedges: Wedges = USUAL) -> str:
    """The node that is 1 because the robot came by the corridor behind it."""
    return feature_name(wedges.code(OPENING, wedges.behind), wedges)


def doorway_name(side: int) -> str:
    """The node that is 1 where the way on one side begins with a doorway."""
    return f"D_{SIDES[side]}"


def declare_network(
    prior: NDArray[np.float64], heading: int, model: SensorModel
) -> DiscreteBayesianNetwork:
    """The network with all detectors of the model, checked by pgmpy.

    ``prior`` is pi(J), (16,), normalised. Raises HeadingError, and ValueError from pgmpy's
    ``check_model`` where the tables do not fit together.
    """
    from pgmpy.factors.discrete import TabularCPD
    from pgmpy.models import DiscreteBayesianNetwork  # here, since this import takes 3 s

    wedges = model.wedges
    net = DiscreteBayesianNetwork()
    net.add_nodes_from([JUNCTION, ASTRAY])
    net.add_cpds(
        TabularCPD(JUNCTION, JUNCTION_TYPES, prior[:, None]),
        TabularCPD(ASTRAY, 2, [[1.0 - model.astray], [model.astray]]),
    )
    for side, direction in _ways_on(heading).items():
        rate = np.array([DOORWAY_RATE * bool(j & direction) for j in range(JUNCTION_TYPES)])
        net.add_edge(JUNCTION, doorway_name(side))
        table = np.array([1.0 - rate, rate])
        net.add_cpds(TabularCPD(doorway_name(side), 2, table, [JUNCTION], [JUNCTION_TYPES]))
    given_x = model.probability.reshape(-1, 2, EVIDENCE_CLASSES)
    astray = model.class_given_state[heading_number(heading), :, -1]
    for d in range(wedges.detectors):
        x, s = feature_name(d, wedges), reading_name(d, wedges)
        doors = _doors_beside(d, wedges)
        parents = [JUNCTION, *map(doorway_name, doors)]
        net.add_edges_from([*((parent, x) for parent in parents), (x, s), (ASTRAY, s)])
        holds = _presence(d, doors, heading, wedges)
        by_state = np.stack([given_x[d], np.broadcast_to(astray[d], given_x[d].shape)], axis=1)
        net.add_cpds(
            TabularCPD(
                x, 2, np.array([1.0 - holds, holds]), parents, [JUNCTION_TYPES, *[2] * len(doors)]
            ),
            TabularCPD(
                s, EVIDENCE_CLASSES, by_state.reshape(4, EVIDENCE_CLASSES).T, [x, ASTRAY], [2, 2]
            ),
        )
    net.check_model()
    return net


def _ways_on(heading: int) -> dict[int, int]:
    """The direction of each side that may have a doorway: the robot came through none."""
    return {AHEAD: heading, LEFT: LEFT_OF[heading], RIGHT: RIGHT_OF[heading]}


def _doors_beside(detector: int, wedges: Wedges) -> list[int]:
    """The sides whose doorways decide what is at a place: those that meet at a corner."""
    place = wedges.place(*wedges.parts(detector))
    if place is None or len(place.sides) < 2:
        return []
    return [side for side in place.sides if side in SIDES]


def _presence(detector: int, doors: list[int], heading: int, wedges: Wedges) -> NDArray[np.float64]:
    """Pr(X=1|J, doorways), (16 * 2^doors,), the last doorway changing fastest."""
    at = wedges.parts(detector)
    ways = _ways_on(heading)
    holds = []
    for junction_type in range(JUNCTION_TYPES):
        for behind_door in product((False, True), repeat=len(doors)):
            walls = sum(ways[side] for side, door in zip(doors, behind_door, strict=True) if door)
            holds.append(presence(junction_type & ~walls, heading, wedges)[at])
    return np.array(holds)


def export_network(
    path: Path, prior: NDArray[np.float64], heading: int, model: SensorModel
) -> None:
    """Write the network as a BIF file, which other libraries of Bayes nets read.

    Arguments and errors as for :func:`declare_network`; raises OSError where it cannot be written.
    """
    from pgmpy.readwrite import BIFWriter

    BIFWriter(declare_network(prior, heading, model), round_values=None).write(str(path))
