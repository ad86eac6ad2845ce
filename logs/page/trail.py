"""Where the robot was at every moment, from what the log holds.

The log has the true pose at every arrival only. Between two of them the robot drove over the
centre of the junction and along the corridor, as far as the wheels counted; while sensing it
did the steps that it was commanded to do, from ping to ping. What its wheels slipped, and how
far it stepped aside for somebody, is not in the log and is not shown.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bus import messages as m
from bus.wire import Sent

NEAR_M = 0.05
"""A knot that lies no farther than this from the line through its neighbours is left out."""


@dataclass(frozen=True)
class Knot:
    """The robot was here then; between two knots it moved evenly."""

    at_ns: int
    x_m: float
    y_m: float
    heading_rad: float


def _after(knot: Knot, kind: int, amount: float) -> Knot:
    """Where a step of motion leads to, at the same time."""
    x_m, y_m, heading_rad = knot.x_m, knot.y_m, knot.heading_rad
    if kind == m.DRIVE:
        x_m += amount * math.cos(heading_rad)
        y_m += amount * math.sin(heading_rad)
    elif kind == m.TURN:
        heading_rad += amount
    return Knot(knot.at_ns, x_m, y_m, heading_rad)


def _at(knot: Knot, at_ns: int) -> Knot:
    return Knot(at_ns, knot.x_m, knot.y_m, knot.heading_rad)


class Trail:
    """Collects the knots of a run. ``knots`` are in the order of their times."""

    def __init__(self) -> None:
        self.knots: list[Knot] = []
        self._building: m.TrueBuilding | None = None
        self._place: int | None = None
        self._wheels: list[tuple[int, float]] = []
        self._ahead: list[Knot] = []
        self._action = 0

    def hear(self, sent: Sent) -> None:
        """Take one message into account; those of no use are passed over."""
        match sent.message:
            case m.TrueBuilding() as building:
                self._building = building
            case m.Departure():
                self._wheels = [(sent.said_ns, 0.0)]
                if self.knots:
                    self.knots.append(_at(self.knots[-1], sent.said_ns))
            case m.Odometry(distance_m=distance_m) if self._wheels:
                self._wheels.append((sent.said_ns, self._wheels[-1][1] + distance_m))
            case m.TruePose() as pose:
                self._arrive(pose, sent.said_ns)
            case _:
                self._sense(sent)

    def _sense(self, sent: Sent) -> None:
        match sent.message:
            case m.Motion() as motion if self.knots:
                here = _at(self.knots[-1], sent.said_ns)
                self.knots.append(here)
                self._action = motion.action
                self._ahead = _at_pings(here, motion.steps)
            case m.Sonar(action=action, fired_ns=fired_ns) if action == self._action:
                if self._ahead and action:
                    self.knots.append(_at(self._ahead.pop(0), fired_ns))
            case m.ActionEnded(action=action) if action == self._action and self._ahead:
                self.knots.append(_at(self._ahead[-1], sent.said_ns))

    def _arrive(self, pose: m.TruePose, at_ns: int) -> None:
        here = Knot(at_ns, pose.x_m, pose.y_m, pose.heading_rad)
        if self._wheels:
            self.knots += self._drive(here)
        self.knots.append(here)
        self._wheels, self._ahead, self._place = [], [], pose.place

    def _drive(self, to: Knot) -> list[Knot]:
        """The knots of a drive that ends at ``to``, without it."""
        driven_m = self._wheels[-1][1]
        began_ns = self._wheels[0][0]
        start = self.knots[-1] if self.knots else _at(_after(to, m.DRIVE, -driven_m), began_ns)
        way = _way(start, self._corner(start), to)
        times = np.array([at_ns for at_ns, _ in self._wheels] + [to.at_ns], dtype=np.float64)
        shares = np.linspace(0.0, 1.0, len(times))
        if driven_m > 0:
            shares = np.array([far_m / driven_m for _, far_m in self._wheels] + [1.0])
        shares = np.maximum.accumulate(np.clip(shares, 0.0, 1.0))
        times = np.append(times, np.interp(way.corner_share, shares, times))
        shares = np.append(shares, way.corner_share)
        order = np.argsort(times, kind="stable")
        knots = [way.at(float(shares[i]), int(times[i])) for i in order]
        # the first of them repeats the start, but for the heading where there is no turn to show
        return [_at(start, began_ns), *_simpler(knots)[:-1]]

    def _corner(self, start: Knot) -> tuple[float, float]:
        """The middle of the junction that the robot leaves by its centre."""
        if self._building is None or self._place is None:
            return start.x_m, start.y_m
        y, x = divmod(self._place, len(self._building.columns_m))
        return float(self._building.columns_m[x]), float(self._building.rows_m[y])


@dataclass(frozen=True)
class _Way:
    """From a pose over a corner to another; ``corner_share`` of the way lies before it."""

    start: Knot
    corner: tuple[float, float]
    end: Knot
    corner_share: float

    def at(self, share: float, at_ns: int) -> Knot:
        (cx, cy), bend = self.corner, self.corner_share
        heading_rad = math.atan2(self.end.y_m - cy, self.end.x_m - cx)
        if share < bend:
            s = share / bend
            x_m = self.start.x_m + s * (cx - self.start.x_m)
            y_m = self.start.y_m + s * (cy - self.start.y_m)
            turn = math.remainder(heading_rad - self.start.heading_rad, 2 * math.pi)
            return Knot(at_ns, x_m, y_m, self.start.heading_rad + s * turn)
        s = (share - bend) / (1.0 - bend) if bend < 1.0 else 1.0
        return Knot(at_ns, cx + s * (self.end.x_m - cx), cy + s * (self.end.y_m - cy), heading_rad)


def _way(start: Knot, corner: tuple[float, float], end: Knot) -> _Way:
    before_m = math.dist((start.x_m, start.y_m), corner)
    after_m = math.dist(corner, (end.x_m, end.y_m))
    whole_m = before_m + after_m
    return _Way(start, corner, end, before_m / whole_m if whole_m > 0 else 0.0)


def _at_pings(here: Knot, steps: NDArray[np.float64]) -> list[Knot]:
    """Where each ping of an action is fired, and last where its steps end."""
    found: list[Knot] = []
    for kind, amount in steps.tolist():
        if round(kind) == m.PING:
            found += [here] * round(amount)
        else:
            here = _after(here, round(kind), amount)
    return [*found, here]


def _simpler(knots: list[Knot]) -> list[Knot]:
    """The same way with fewer knots: none is farther than NEAR_M from where it was."""
    kept = knots[:1]
    for before, knot, after in zip(knots, knots[1:], knots[2:], strict=False):
        if _off_m(kept[-1], knot, after) > NEAR_M or before.heading_rad != after.heading_rad:
            kept.append(knot)
    return kept + knots[1:][-1:]


def _off_m(a: Knot, b: Knot, c: Knot) -> float:
    share = (b.at_ns - a.at_ns) / (c.at_ns - a.at_ns) if c.at_ns > a.at_ns else 0.0
    return math.hypot(
        a.x_m + share * (c.x_m - a.x_m) - b.x_m, a.y_m + share * (c.y_m - a.y_m) - b.y_m
    )
