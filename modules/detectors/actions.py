"""What a detector does: drive to its vantage, face its target, ping, and come back.

Each feature detector is "a control process that directs the robot's movement and sensing"
(paper, section 2); one takes "about thirty seconds to a minute" (section 5), here because of
the way there and back at a crawl.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Literal, NamedTuple

from bus.features import USUAL, Wedges
from modules.detectors.views import DetectorError, view_of

SWEEP_RAD = tuple(math.radians(degrees) for degrees in (-3.0, -1.0, 1.0, 3.0))
"""Offsets from the view's direction at which it pings: echoes that hang on the exact heading
fade during the sweep, those of a surface that is looked for do not."""

PINGS_EACH = 3
"""Pings at each offset."""


class Step(NamedTuple):
    """One primitive motion: metres driven (forwards > 0), radians turned (left > 0), or pings."""

    kind: Literal["drive", "turn", "ping"]
    amount: float


def plan(
    feature: int, wedge: int, nominal_width_m: float, wedges: Wedges = USUAL
) -> tuple[Step, ...]:
    """The steps of detector d_{f,w}, which starts and ends at the port, heading as on exit.

    Raises DetectorError for an unknown detector or a width that is not positive.
    """
    check_width(nominal_width_m)
    view = view_of(feature, wedge, wedges)
    there = Step("drive", view.vantage * nominal_width_m / 2)
    nearer = Step("drive", view.approach * nominal_width_m / 2)
    steps = [there]
    faced_rad = 0.0
    if nearer.amount:
        steps += [Step("turn", view.facing_rad), nearer]
        faced_rad = view.facing_rad
    for offset_rad in SWEEP_RAD:
        steps.append(Step("turn", view.facing_rad + offset_rad - faced_rad))
        steps.append(Step("ping", PINGS_EACH))
        faced_rad = view.facing_rad + offset_rad
    if nearer.amount:
        steps += [Step("turn", view.facing_rad - faced_rad), Step("drive", -nearer.amount)]
        faced_rad = view.facing_rad
    steps += [Step("turn", -faced_rad), Step("drive", -there.amount)]
    return tuple(step for step in steps if step.amount != 0.0)


def ping_offsets_rad() -> tuple[float, ...]:
    """How far each ping of a plan is turned from its view's direction, in order."""
    return tuple(offset for offset in SWEEP_RAD for _ in range(PINGS_EACH))


def duration_s(steps: Sequence[Step], crawl_m_s: float, turn_rad_s: float, ping_s: float) -> float:
    """Seconds the steps take at these speeds. Raises DetectorError unless all are positive."""
    if not (crawl_m_s > 0 and turn_rad_s > 0 and ping_s > 0):
        raise DetectorError(
            f"speeds and the time of a ping must be positive, got {crawl_m_s} m/s, "
            f"{turn_rad_s} rad/s, {ping_s} s"
        )
    seconds_each = {"drive": 1 / crawl_m_s, "turn": 1 / turn_rad_s, "ping": ping_s}
    return sum(abs(step.amount) * seconds_each[step.kind] for step in steps)


def check_width(nominal_width_m: float) -> None:
    """Raise DetectorError unless a corridor can have this width."""
    if not (math.isfinite(nominal_width_m) and nominal_width_m > 0):
        raise DetectorError(f"a corridor's width must be positive, got {nominal_width_m} m")
