"""The classifier's Bayes net J -> X_{f,w} -> S_{f,w}, declared (paper, section 3).

The running code multiplies compiled tables; this declaration is what they must agree with.
That the robot came by the corridor behind is hard evidence: X of the opening in wedge 4.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from bus.features import DETECTORS, FEATURES, OPENING, WEDGES
from bus.grid import JUNCTION_TYPES
from modules.classifier.geometry import heading_number, presence_table
from modules.classifier.sensor_model import EVIDENCE_CLASSES, SensorModel

if TYPE_CHECKING:
    from pgmpy.models import DiscreteBayesianNetwork

JUNCTION = "J"


def feature_name(detector: int) -> str:
    """The node X_{f,w} that a detector tests."""
    return f"X_{FEATURES[detector // WEDGES]}_{detector % WEDGES}"


def reading_name(detector: int) -> str:
    """The node S_{f,w} of a detector's evidence class."""
    return f"S_{FEATURES[detector // WEDGES]}_{detector % WEDGES}"


CAME_BY = feature_name(OPENING * WEDGES + WEDGES // 2)
"""The node that is 1 because the robot came by the corridor behind it."""


def declare_network(
    prior: NDArray[np.float64], heading: int, model: SensorModel
) -> DiscreteBayesianNetwork:
    """The network with all 24 detectors, checked by pgmpy.

    ``prior`` is pi(J), (16,), normalised. Raises HeadingError, and ValueError from pgmpy's
    ``check_model`` where the tables do not fit together.
    """
    from pgmpy.factors.discrete import TabularCPD
    from pgmpy.models import DiscreteBayesianNetwork  # here, since this import takes 3 s

    present = presence_table()[heading_number(heading)].reshape(JUNCTION_TYPES, DETECTORS)
    classes = model.probability.reshape(DETECTORS, 2, EVIDENCE_CLASSES)
    net = DiscreteBayesianNetwork()
    net.add_node(JUNCTION)
    net.add_cpds(TabularCPD(JUNCTION, JUNCTION_TYPES, prior[:, None]))
    for d in range(DETECTORS):
        x, s = feature_name(d), reading_name(d)
        net.add_edges_from([(JUNCTION, x), (x, s)])
        holds = present[:, d].astype(np.float64)
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
