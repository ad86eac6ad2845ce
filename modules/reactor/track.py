"""Does something approach? A belief over the things ahead, ping by ping.

Only the transducers that look ahead matter: number 0 and its two neighbours. An echo that no
known thing explains starts a new one; things that nothing speaks for are dropped.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from modules.reactor.cone import Floats
from modules.reactor.thing import EchoModel, Thing, born, hidden, listened, moved

FORWARD = (0, 1, -1)
"""The transducers that look ahead, in the order of ``thing.AXES_RAD``."""

MOST_THINGS = 6
SETTLED = 0.95
"""Probability from which a thing counts as known to stand."""

GONE = 0.97
"""Probability of a false echo from which a thing is dropped."""

SAME_M = 0.45
"""New echoes no further apart than this are of one new thing (a radius and the noise)."""


class ScanError(ValueError):
    """A scan that cannot be used: wrong shape, not after the one before."""


@dataclass(frozen=True)
class Scan:
    """One ping of the ring as distributions.

    ``mean_m`` (transducers,) with nan where no echo came back, ``sigma_m`` (transducers,);
    ``speed_m_s`` is the robot's own along the corridor since the last scan, ``lateral_m`` how
    far left of the centre line it is. Raises ScanError for ranges of unequal or no length.
    """

    time_s: float
    mean_m: Floats
    sigma_m: Floats
    speed_m_s: float = 0.0
    lateral_m: float = 0.0

    def __post_init__(self) -> None:
        if self.mean_m.shape != self.sigma_m.shape or self.mean_m.ndim != 1 or len(self.mean_m) < 3:
            raise ScanError(
                "a scan needs mean_m and sigma_m of one length of at least 3, got shapes "
                f"{self.mean_m.shape} and {self.sigma_m.shape}"
            )


@dataclass(frozen=True)
class Tracker:
    """The things ahead, after the last scan; ``Tracker()`` knows of none.

    ``cells`` is the number of table entries that the last update touched.
    """

    model: EchoModel = field(default_factory=EchoModel)
    time_s: float | None = None
    things: tuple[Thing, ...] = ()
    lateral_m: float = 0.0
    last_alert_s: float = -np.inf
    cells: int = 0

    attention_at: float = 0.01
    """Probability of an approaching thing from which faster pings are wanted."""

    @property
    def approaching(self) -> float:
        """Probability of the thing that most likely approaches that it does."""
        return max((thing.approaching for thing in self.things), default=0.0)

    @property
    def wants_attention(self) -> bool:
        """Whether faster pings are wanted: something ahead may approach."""
        return self.approaching > self.attention_at

    @property
    def quiet_s(self) -> float:
        """Seconds for which nothing has called for attention."""
        return np.inf if self.time_s is None else self.time_s - self.last_alert_s


def updated(tracker: Tracker, scan: Scan) -> Tracker:
    """The tracker after a scan. Raises ScanError for a scan that is not after the last one."""
    elapsed_s = 0.0 if tracker.time_s is None else scan.time_s - tracker.time_s
    if elapsed_s < 0 or (elapsed_s == 0 and tracker.time_s is not None):
        raise ScanError(f"scans must follow in time: {scan.time_s} s after {tracker.time_s} s")
    model = tracker.model
    things = [moved(t, scan.speed_m_s * elapsed_s, elapsed_s, model) for t in tracker.things]
    things, explained = _heard(things, scan, model)
    cells = sum(len(FORWARD) * t.weight.size for t in things)
    new = _new_things(scan, explained, model)
    after = replace(
        tracker,
        time_s=scan.time_s,
        things=_kept([*things, *new]),
        lateral_m=scan.lateral_m,
        cells=cells + sum(t.weight.size for t in new) + len(FORWARD),
    )
    return replace(after, last_alert_s=scan.time_s) if after.wants_attention else after


def _heard(
    things: Sequence[Thing], scan: Scan, model: EchoModel
) -> tuple[list[Thing], list[float]]:
    """Every thing after every forward echo; how well each echo is explained."""
    # What is known to stand claims its echoes first, the nearest first: it hides the rest.
    order = sorted(range(len(things)), key=lambda k: _claim(things[k]))
    after = list(things)
    explained = [0.0] * len(FORWARD)
    walls = [0.0] * len(FORWARD)
    for k in order:
        settled = things[k].standing > SETTLED
        after[k], shares = _listen(after[k], scan, walls, model)
        explained = [max(a, b) for a, b in zip(explained, shares, strict=True)]
        if settled:
            walls = [max(a, b) for a, b in zip(walls, shares, strict=True)]
    return after, explained


def _claim(thing: Thing) -> tuple[bool, float]:
    """Sorts things by who claims an echo first."""
    settled = thing.standing > SETTLED
    return not settled, thing.stands_at_m if settled else 0.0


def _listen(
    thing: Thing, scan: Scan, walls: Sequence[float], model: EchoModel
) -> tuple[Thing, list[float]]:
    """One thing after the forward echoes; ``walls`` says which are of a thing that stands."""
    shares = []
    for cone, k in enumerate(FORWARD):
        echo_m, sigma_m = float(scan.mean_m[k]), float(scan.sigma_m[k])
        if walls[cone] > 0.5:
            thing, share = hidden(thing, cone, echo_m, sigma_m, scan.lateral_m, model), 0.0
        else:
            thing, share = listened(thing, cone, echo_m, sigma_m, scan.lateral_m, model)
        shares.append(share)
    if max(shares) > 0.5:
        thing = replace(thing, pings=thing.pings + 1, heard_s=scan.time_s)
    return thing, shares


def _new_things(scan: Scan, explained: Sequence[float], model: EchoModel) -> list[Thing]:
    """A thing for each group of echoes that nothing known explains, the nearest echo first."""
    echoes = [float(scan.mean_m[k]) for k in FORWARD]
    free = [c for c in range(len(FORWARD)) if not np.isnan(echoes[c]) and explained[c] < 0.5]
    left = sorted(free, key=lambda c: echoes[c])
    new = []
    while left:
        group = [c for c in left if echoes[c] - echoes[left[0]] <= SAME_M]
        new.append(_new_thing(scan, left[0], explained, model))
        left = [c for c in left if c not in group]
    return new


def _new_thing(scan: Scan, first: int, explained: Sequence[float], model: EchoModel) -> Thing:
    """A thing that forward cone ``first`` heard, after what the others heard or did not."""
    echo_m, sigma_m = float(scan.mean_m[FORWARD[first]]), float(scan.sigma_m[FORWARD[first]])
    thing = born(first, echo_m, sigma_m, scan.lateral_m, scan.time_s, model)
    for cone, k in enumerate(FORWARD):
        other, sigma_m = float(scan.mean_m[k]), float(scan.sigma_m[k])
        if cone != first and explained[cone] < 0.5:
            thing, _ = listened(thing, cone, other, sigma_m, scan.lateral_m, model)
    return thing


def _kept(things: Sequence[Thing]) -> tuple[Thing, ...]:
    """The things that are likely enough to be there, the likeliest few, none twice."""
    real = [t for t in things if t.false < GONE]
    once = [t for k, t in enumerate(real) if not any(_same(t, u) for u in real[:k])]
    most = sorted(once, key=lambda t: t.false)[:MOST_THINGS]
    return tuple(sorted(most, key=lambda t: t.first_s))


def _same(a: Thing, b: Thing) -> bool:
    """Whether two things that stand are one: as far away, and on the same side."""
    if min(a.standing, b.standing) < SETTLED or abs(a.stands_at_m - b.stands_at_m) > SAME_M:
        return False
    lines = [t.weight[0] / t.standing for t in (a, b)]
    return float(np.minimum(*lines).sum()) > 0.5
