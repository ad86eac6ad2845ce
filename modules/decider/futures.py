"""The expected cost of future tasks, kept in a table of (plan, truth) pairs."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from modules.decider.hypotheses import Hypotheses
from modules.decider.roads import Roads
from modules.decider.value_kernels import Tasks, fill_entries, most_probable_given


@dataclass
class FutureTable:
    """Futures(M_true, I) = sum_j E|T_j| Cost(T_j, M*_I, M_true) for the maps of one set.

    The paper fills the table for all pairs first; here an entry is reckoned when it is asked
    for, and never twice: few of the maps are ever the most probable one.
    """

    roads: Roads
    tasks: Tasks
    hypotheses: Hypotheses
    reckoned: int = 0
    """Entries reckoned so far."""
    table: NDArray[np.float64] = field(init=False)
    """(plan, truth): seconds, NaN where not reckoned yet."""

    def __post_init__(self) -> None:
        n, places = len(self.hypotheses.maps), len(self.roads.corridor)
        self.table = np.full((n, n), np.nan if len(self.tasks.start) else 0.0)
        self._fields = np.empty((n, places, places))
        self._ready = np.zeros((n, places), dtype=np.bool_)

    def plans_given(self, observed: NDArray[np.int64]) -> NDArray[np.int64]:
        """The plan M*_[O, E] that each map would leave the robot with; reckons its entries.

        ``observed`` (options, maps) is what each option shows under each map. M*_[O, E] is the
        most probable map among those that show the same, by the exact posterior; ties go to
        the lowest index.
        """
        plans = most_probable_given(
            observed, self.hypotheses.log_probability, len(self.roads.corridor)
        )
        self.reckoned += fill_entries(
            self.roads,
            self.tasks,
            self.hypotheses.maps,
            plans,
            self.table,
            self._fields,
            self._ready,
        )
        return plans
