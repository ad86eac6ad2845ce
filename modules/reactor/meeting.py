"""What comes of an act: does the robot touch what comes, by the geometry of the corridor.

Robot and thing move along straight pieces, so their least separation over an encounter is
found piece by piece, exactly. Coordinates: metres ahead of and left of the place on the centre
line where the robot is when it decides.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from modules.reactor.cone import Flags, Floats

ACTS = ("continue", "slow", "stop", "pull aside left", "pull aside right", "back up")
"""The words of ``decision/reaction``."""

GRAZE_M = 1e-9
"""Who comes exactly as near as the radii does not touch, whatever the rounding."""


@dataclass(frozen=True)
class Body:
    """How the robot moves, and its size; the drive speed is that of the paper's four minutes."""

    radius_m: float = 0.3
    speed_m_s: float = 0.085
    lateral_m_s: float = 0.3
    aside_m: float = 0.6

    def along_m_s(self, act: str) -> float:
        """Speed along the corridor while doing an act."""
        return {"continue": 1.0, "slow": 0.5, "back up": -1.0}.get(act, 0.0) * self.speed_m_s

    def goes_to_m(self, act: str, lateral_m: float) -> float:
        """Where across the corridor an act ends: 0 is the centre line, left is positive."""
        sides = {
            "continue": 0.0,
            "slow": 0.0,
            "pull aside left": self.aside_m,
            "pull aside right": -self.aside_m,
        }
        return sides.get(act, lateral_m)

    def across_m(self, act: str, lateral_m: float, elapsed_s: float) -> float:
        """How far left of the centre line the robot is after doing an act for a while."""
        step = self.lateral_m_s * elapsed_s
        off = self.goes_to_m(act, lateral_m) - lateral_m
        return lateral_m + max(-step, min(step, off))


@dataclass(frozen=True)
class Walking:
    """How people walk. One who yields sidesteps at ``notices_m`` to ``aside_m`` off the centre."""

    radius_m: float = 0.25
    sidestep_m_s: float = 0.9
    notices_m: float = 2.0
    aside_m: float = 0.75


def touches_walker(
    act: str,
    yields: bool,
    lateral_m: float,
    ahead_m: Floats,
    line_m: Floats,
    speed_m_s: Floats,
    body: Body,
    walking: Walking,
) -> Flags:
    """Whether a robot at ``lateral_m`` that does ``act`` touches a person before he has passed.

    ``ahead_m`` how far ahead he is, ``line_m`` how far left of the centre line he walks,
    ``speed_m_s`` how fast; they broadcast, and so does the answer.
    """
    ahead, line, speed = np.broadcast_arrays(ahead_m, line_m, speed_m_s)
    closing = speed + body.along_m_s(act)
    goal = body.goes_to_m(act, lateral_m)
    noticed = np.maximum((ahead - walking.notices_m) / closing, 0.0)
    meets = _towards(np.full_like(line, lateral_m), goal, body.lateral_m_s * noticed)
    free = np.where(np.abs(meets) > body.radius_m / 2, -meets, line)
    side = np.where(yields, np.copysign(walking.aside_m, free), line)
    moves = [
        np.full_like(line, abs(goal - lateral_m) / body.lateral_m_s),
        noticed,
        noticed + np.abs(side - line) / walking.sidestep_m_s,
    ]
    passed = (ahead + 1.0) / closing
    times = np.sort(np.stack([np.zeros_like(line), *moves, passed]), axis=0)
    times = np.minimum(times, passed)
    across = _towards(line, side, walking.sidestep_m_s * np.maximum(times - noticed, 0.0))
    across = across - _towards(np.full_like(line, lateral_m), goal, body.lateral_m_s * times)
    least = least_separation_m(ahead - closing * times, across)
    return least < body.radius_m + walking.radius_m - GRAZE_M


def touches_standing(
    act: str,
    lateral_m: float,
    ahead_m: Floats,
    line_m: Floats,
    until_s: float,
    body: Body,
    walking: Walking,
) -> Flags:
    """Whether a robot that does ``act`` touches a thing that stands, within ``until_s``.

    A thing that stands can be thought about again at the next ping, so only what happens until
    then is charged to the act.
    """
    ahead, line = np.broadcast_arrays(ahead_m, line_m)
    goal = body.goes_to_m(act, lateral_m)
    done = min(abs(goal - lateral_m) / body.lateral_m_s, until_s)
    times = np.array([0.0, done, until_s]).reshape(3, *[1] * ahead.ndim)
    mine = _towards(np.full_like(times, lateral_m), goal, body.lateral_m_s * times)
    least = least_separation_m(ahead - body.along_m_s(act) * times, line - mine)
    # How big a thing is that was left in a corridor is not known: as big as a person, say.
    return least < body.radius_m + walking.radius_m - GRAZE_M


def least_separation_m(ahead_m: Floats, across_m: Floats) -> Floats:
    """Least distance from the origin of a path of straight pieces: (points, ...) -> (...)."""
    px, py = ahead_m[:-1], across_m[:-1]
    dx, dy = np.diff(ahead_m, axis=0), np.diff(across_m, axis=0)
    length2 = dx * dx + dy * dy
    share = np.divide(-(px * dx + py * dy), length2, out=np.zeros_like(dx), where=length2 > 0)
    share = np.clip(share, 0.0, 1.0)
    least: Floats = np.hypot(px + share * dx, py + share * dy).min(axis=0)
    return least


def _towards(value: Floats, goal: Floats | float, step: Floats) -> Floats:
    """``value`` moved towards ``goal`` by at most ``step``."""
    moved: Floats = value + np.clip(goal - value, -step, step)
    return moved
