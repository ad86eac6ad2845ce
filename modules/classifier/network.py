"""The classifier's Bayes net J -> X_{f,w} -> S_{f,w}, declared (paper, section 3).

The running code multiplies compiled tables; this declaration is what they must agree with.
That the robot came by the corridor behind is hard evidence: X of the opening behind.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from bus.features import FEATURES, OPENING, USUAL, Wedges
from bus.grid import JUNCTION_TYPES
from modules.classifier.geometry import heading_number, presence_table
from modules.classifier.sensor_model import EVIDENCE_CLASSES, SensorModel

if TYPE_CHECKING:
    from pgmpy.models import DiscreteBayesianNetwork

JUNCTION = "J"


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
    present = presence_table(wedges)[heading_number(heading)].reshape(JUNCTION_TYPES, -1)
    classes = model.probability.reshape(-1, 2, EVIDENCE_CLASSES)
    net = DiscreteBayesianNetwork()
    net.add_node(JUNCTION)
    net.add_cpds(TabularCPD(JUNCTION, JUNCTION_TYPES, prior[:, None]))
    for d in range(wedges.detectors):
        x, s = feature_name(d, wedges), reading_name(d, wedges)
        net.add_edges_from([(JUNCTION, x), (x, s)])
        holds = present[:, d]
        net.add_cpds(
            TabularCPD(x, 2, np.array([1.0 - holds, holds]), [JUNCTION], [JUNCTION_TYPES]),
            TabularCPD(s, EVIDENCE_CLASSES, classes[d].T, [x], [2]),
        )
    net.check_model()
    return net


def export_network(
    path: Path, prior: NDArray[np.float64], heading: int, model: SensorModel
) -> None:
    """Write the network as a BIF file, which other libraries of Bayes nets read.

    Arguments and errors as for :func:`declare_network`; raises OSError where it cannot be written.
    """
    from pgmpy.readwrite import BIFWriter

    BIFWriter(declare_network(prior, heading, model), round_values=None).write(str(path))
