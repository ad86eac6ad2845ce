"""Is this the same intersection? Whether a detour to make sure is worth its time (section 2).

"On the basis of how much time you have and how important it is for you to establish your location
with regard to that recalled intersection, you will have to choose whether or not it is worth your
while to look for the restaurant." A registration is a place where the robot may be. A detour costs
time and tells the registrations apart, more or less; then the robot acts on one of them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


class FamiliarError(ValueError):
    """A question that does not fit together: what, found, expected."""


@dataclass(frozen=True, eq=False)
class Familiar:
    """What the decision rests on; times in seconds.

    A *case* is a registration, or one with a map of what is around it.
    """

    probability: NDArray[np.float64]
    """(cases,): they sum to 1."""
    act_s: NDArray[np.float64]
    """(acts, cases): what is left of the errand by each act, where each is the case."""
    after_s: NDArray[np.float64]
    """(acts, cases): the same where the detour is made first, its time included."""
    shows: NDArray[np.float64]
    """(outcomes, cases): P(what the detour shows | case)."""
    left_s: float = np.inf
    """Time until the errand is late; negative where it is late already."""
    late_price: float = 0.0
    """What each late second costs more, in seconds."""

    def __post_init__(self) -> None:
        n = len(self.probability)
        for name, found in (("act_s", self.act_s), ("shows", self.shows)):
            if found.ndim != 2 or found.shape[1] != n or not len(found):
                raise FamiliarError(f"{name}: found shape {found.shape}, expected (some, {n})")
        if self.after_s.shape != self.act_s.shape:
            shapes = f"found shape {self.after_s.shape}, expected {self.act_s.shape}, as of act_s"
            raise FamiliarError(f"after_s: {shapes}")
        for name, sums in (("probability", self.probability.sum()), ("shows", self.shows.sum(0))):
            if not np.allclose(sums, 1.0, atol=1e-9):
                raise FamiliarError(f"{name}: found a sum of {sums}, expected 1")
        if not (self.probability >= 0).all() or not (self.shows >= 0).all():
            raise FamiliarError("probabilities: found a negative one, expected at least 0")

    @classmethod
    def there_and_back(
        cls,
        probability: NDArray[np.float64],
        act_s: NDArray[np.float64],
        look_s: float,
        shows: NDArray[np.float64],
        left_s: float = np.inf,
        late_price: float = 0.0,
    ) -> Familiar:
        """A detour that takes ``look_s`` and leads back to where the errand goes on."""
        return cls(probability, act_s, look_s + act_s, shows, left_s, late_price)

    def cost_s(self, taken_s: NDArray[np.float64]) -> NDArray[np.float64]:
        """What an errand costs that takes so long."""
        if not self.late_price:
            return taken_s
        return taken_s + self.late_price * np.maximum(0.0, taken_s - self.left_s)


@dataclass(frozen=True)
class Detour:
    """The decision, and what it is made by."""

    now_s: float
    """Least expected cost of acting at once."""
    look_s: float
    """Expected cost of looking first, the detour's time included."""
    act: int
    """The best act at once; ties go to the first."""
    acts: tuple[int, ...]
    """The best act after each outcome of the detour."""

    @property
    def worth_s(self) -> float:
        """What the detour saves; negative where it costs more than it saves."""
        return self.now_s - self.look_s

    @property
    def pays(self) -> bool:
        """Whether to make the detour: only if it truly saves time, beyond rounding."""
        return self.worth_s > 1e-9 * abs(self.now_s)


def decide_detour(asked: Familiar) -> Detour:
    """Act at once, or look first and act by what that shows, whichever costs less on average."""
    now = asked.cost_s(asked.act_s) @ asked.probability
    joint = asked.shows * asked.probability
    after = joint @ asked.cost_s(asked.after_s).T  # (outcomes, acts), times their probability
    acts = after.argmin(axis=1)
    look = float(sum(after.min(axis=1).tolist()))
    return Detour(float(now.min()), look, int(now.argmin()), tuple(int(a) for a in acts))
