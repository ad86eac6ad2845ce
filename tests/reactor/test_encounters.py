"""People meet the robot: sonar, tracker, decision, motion, closed into a loop."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field
from functools import cache
from typing import cast

import numpy as np
import pytest
from numpy.typing import NDArray

from bus.facts import Ring
from modules.reactor import Scan, Settings, Tracker, compiled, react, updated
from modules.reactor.cone import cones_ahead
from modules.reactor.openness import Sectors, sectors_of
from modules.reactor.sides import PINGS, beside
from simworld.building import Building, build
from simworld.people import (
    Act,
    Person,
    RobotInCorridor,
    Walker,
    advance,
    collides,
    deadline_s,
    walked,
)
from simworld.sonar import SonarRing, echoes

DT_S = 0.05
ORDINARY_S, FAST_S = 2.0, 0.25
RING, USUAL = SonarRing(), Ring()
DIAGRAM = compiled(Settings())
START_M, LENGTH_M = 3.0, 26.4
ENTERS_S = 3.0
SEEDS = 300


@cache
def corridor() -> Building:
    """A corridor of 26.4 m along y = 0, with junctions at its ends."""
    return build([0.0, LENGTH_M], [0.0, 20.0], np.array([1, 0, 1, 1], np.uint8), 2.0)


def ping(
    robot: RobotInCorridor,
    walker: Walker | None,
    person: Person | None,
    time_s: float,
    rng: np.random.Generator,
    ring: SonarRing = RING,
) -> Scan:
    """One ping of a robot that drives east along y = 0."""
    there = [(walker.s_m, walker.y_m, person.radius_m)] if walker and person else []
    heard = echoes(ring, corridor(), robot.s_m, robot.y_m, 0.0, rng, there)
    sigma = ring.sigma_m(np.nan_to_num(heard))
    return Scan(time_s, heard, sigma, robot.speed_m_s, robot.y_m)


@dataclass
class Mind:
    """The reactor at work: what it hears, and when what it decides is done.

    Decisions are done ``delay_s`` after they are made; none is made before ``not_before_s``.
    """

    delay_s: float = 0.0
    ring: Ring = USUAL
    tracker: Tracker = field(init=False)
    sectors: Sectors = field(init=False)
    decided: list[tuple[float, Act]] = field(default_factory=list)
    pings: deque[NDArray[np.float64]] = field(default_factory=lambda: deque(maxlen=PINGS))

    def __post_init__(self) -> None:
        self.tracker = Tracker(cones=cones_ahead(self.ring))
        self.sectors = sectors_of(self.ring)

    def hear(self, scan: Scan, not_before_s: float) -> float:
        """Take in a ping; seconds until the next."""
        self.tracker = updated(self.tracker, scan)
        wait_s = FAST_S if self.tracker.wants_attention else ORDINARY_S
        self.pings.append(self.sectors.free_m(scan.mean_m))
        sides = beside(tuple(self.pings), self.sectors, scan.lateral_m, DIAGRAM.settings.body)
        reaction = react(self.tracker, self.last, DIAGRAM, sides)
        if reaction is None or not reaction.due or scan.time_s + FAST_S <= not_before_s:
            return wait_s
        if reaction.act != self.last:
            self.decided.append((scan.time_s + self.delay_s, cast(Act, reaction.act)))
        return wait_s

    @property
    def last(self) -> Act:
        """What was decided last."""
        return self.decided[-1][1] if self.decided else "continue"

    def act(self, time_s: float) -> Act:
        """What has been decided and heard by now."""
        return next((act for at, act in reversed(self.decided) if at <= time_s), "continue")


@dataclass(frozen=True)
class Outcome:
    """What came of an encounter."""

    touched: bool
    acts: tuple[tuple[float, Act], ...]
    deadline_s: float
    robot: RobotInCorridor

    @property
    def late(self) -> bool:
        """Whether the first act came after the deadline."""
        return bool(self.acts) and self.acts[0][0] > self.deadline_s


def meet(
    person: Person,
    seed: int,
    delay_s: float = 0.0,
    wait: bool = False,
    start_m: float = START_M,
    lasts_s: float | None = None,
    ring: SonarRing = RING,
) -> Outcome:
    """Drive until the person has passed or been touched, or for ``lasts_s`` seconds.

    The person enters at the moment of an ordinary ping, as in the simulated world. With
    ``wait`` nothing is decided before the deadline.
    """
    rng = np.random.default_rng(seed)
    robot, walker, mind = RobotInCorridor(start_m), None, Mind(delay_s, known(ring))
    next_s, due_s, touched, met = person.enters_s % ORDINARY_S, np.inf, False, False
    acts: list[tuple[float, Act]] = []
    for k in range(round((lasts_s or 60.0) / DT_S)):
        t = k * DT_S
        if walker is not None and not met:
            met = True
            due_s = deadline_s(person, walker, robot, t)
        if t >= next_s:
            next_s = t + mind.hear(
                ping(robot, walker, person, t, rng, ring), due_s if wait else 0.0
            )
        act = mind.act(t)
        if act != (acts[-1][1] if acts else "continue"):
            acts.append((t, act))
        walker, robot = walked(person, walker, robot, t, DT_S), advance(robot, act, DT_S)
        touched = touched or (walker is not None and collides(person, walker, robot))
        if lasts_s is None and (touched or (met and walker is None)):
            break
    return Outcome(touched, tuple(acts), due_s, robot)


def known(ring: SonarRing) -> Ring:
    """What a robot knows of its ring."""
    return Ring(ring.transducers, ring.half_angle_rad, ring.nearest_m, ring.farthest_m)


def stranger(seed: int, yields: bool, appears: str = "ahead") -> Person:
    """Someone who comes from 7 to 10 m ahead at 0.8 to 1.8 m/s on any line of the corridor."""
    rng = np.random.default_rng([seed, 7])
    return Person(
        ENTERS_S,
        START_M + 0.085 * ENTERS_S + float(rng.uniform(7.0, 10.0)),
        float(rng.uniform(0.8, 1.8)),
        float(rng.uniform(-0.75, 0.75)),
        yields,
        appears=appears,  # type: ignore[arg-type]
    )


def met(
    yields: bool, delay_s: float = 0.0, wait: bool = False, seeds: int = SEEDS
) -> list[Outcome]:
    """What came of so many encounters."""
    return [meet(stranger(seed, yields), seed, delay_s, wait) for seed in range(seeds)]


@pytest.mark.parametrize("wait", [False, True], ids=["at once", "by the deadline"])
@pytest.mark.parametrize("yields", [False, True], ids=["does not yield", "yields"])
def test_nobody_is_touched_by_a_decision_in_time(yields: bool, wait: bool) -> None:
    outcomes = met(yields, wait=wait)
    assert sum(outcome.touched for outcome in outcomes) == 0
    assert sum(outcome.late for outcome in outcomes) <= 2
    # With "continue" at the end these are one more.
    assert max(len(outcome.acts) for outcome in outcomes) <= 4
    assert sum(len(outcome.acts) > 2 for outcome in outcomes) <= 0.05 * SEEDS


def test_who_does_not_yield_is_hit_by_a_decision_six_seconds_late() -> None:
    outcomes = met(yields=False, delay_s=6.0, seeds=200)
    assert sum(outcome.touched for outcome in outcomes) >= 0.5 * 200
    assert not any(outcome.touched for outcome in outcomes if not outcome.late and outcome.acts)


def test_without_a_reactor_most_who_do_not_yield_are_hit() -> None:
    # The centre line leaves 0.5 m on either side of 0.75: 0.5 / 0.75 = 67 % are hit.
    outcomes = met(yields=False, delay_s=1000.0, seeds=200)
    assert 0.57 * 200 < sum(outcome.touched for outcome in outcomes) < 0.76 * 200


@pytest.mark.parametrize(
    ("transducers", "half_angle_deg", "most"),
    [
        (16, 20.0, 1),
        (24, 7.5, 1),
        (36, 10.0, 1),
        (48, 7.5, 1),
        (48, 15.0, 1),
        # The cones next to the middle one begin off the middle, or reach across it: they tell
        # only late on which side somebody walks.
        (16, 15.0, 3),
        (24, 20.0, 6),
    ],
)
def test_other_rings_see_who_comes(transducers: int, half_angle_deg: float, most: int) -> None:
    ring = SonarRing(transducers=transducers, half_angle_rad=np.deg2rad(half_angle_deg))
    outcomes = [meet(stranger(seed, False), seed, ring=ring) for seed in range(40)]
    assert sum(outcome.touched for outcome in outcomes) <= most  # of 27 that never react
    assert sum(outcome.late for outcome in outcomes) <= 2


@pytest.mark.parametrize("side", ["left door", "right door"])
def test_who_steps_out_of_a_door_is_mostly_avoided(side: str) -> None:
    # The reactor believes that people walk along lines; these cross all of them first.
    hit = [seed for seed in range(60) if meet(stranger(seed, False, side), seed).touched]
    assert len(hit) <= 1


def test_after_the_person_has_passed_the_robot_drives_on_along_the_centre() -> None:
    for seed in range(20):
        after = meet(stranger(seed, True), seed, lasts_s=30.0)
        assert after.acts == () or after.acts[-1][1] == "continue"
        assert after.robot.y_m == pytest.approx(0.0, abs=1e-9)
        assert after.robot.speed_m_s > 0


@pytest.mark.parametrize("offset_m", [-0.4, -0.25, -0.2, 0.0, 0.2, 0.25, 0.4])
def test_a_thing_left_in_the_way_is_passed_on_the_side_it_leaves_free(offset_m: float) -> None:
    box = Person(0.0, 11.0, 0.0, offset_m)
    free = {"pass left", "pass right"} if offset_m == 0.0 else {"pass left"}
    free = {"pass right"} if offset_m > 0.0 else free
    for seed in range(8):
        # Half a metre at 0.085 m/s, then 1.5 m and 0.6 m at half of it.
        after = meet(box, seed, start_m=9.0, lasts_s=90.0)
        assert not after.touched
        assert after.acts[0][1] in free
        assert {act for _, act in after.acts} <= {after.acts[0][1], "slow", "continue"}
        assert after.acts[-1][1] == "continue" and len(after.acts) <= 4
        assert after.robot.s_m > 11.6 and after.robot.y_m == pytest.approx(0.0, abs=1e-9)


def test_driving_a_plain_corridor_alarms_nobody() -> None:
    pings = fast = 0
    false_alarms = []
    for seed in range(20):
        rng = np.random.default_rng([seed, 11])
        robot, mind, t = RobotInCorridor(1.5), Mind(), 0.0
        while robot.s_m < LENGTH_M:
            wait_s = mind.hear(ping(robot, None, None, t, rng), 0.0)
            robot, t = advance(robot, "continue", wait_s), t + wait_s
            pings, fast = pings + 1, fast + (wait_s == FAST_S)
        false_alarms += [(seed, at, act) for at, act in mind.decided if act != "continue"]
    assert pings > 2900
    assert false_alarms == []
    assert fast < 0.1 * pings


def test_the_same_seed_meets_alike() -> None:
    assert meet(stranger(3, False), 3) == meet(stranger(3, False), 3)
