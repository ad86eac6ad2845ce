"""Determine experimentally what readings are worth: Pr(S|X) for every detector.

The paper (section 3) determines these numbers by experiment; here the experiment is simulated.
A trial is one junction of random type, entered by a random heading in a corridor of random width,
a little off the axis and askew, where every detector is run once on a body whose odometry errs.
Each trial has its own random numbers, so the counts depend on the seed and the number of trials
alone, never on how many workers share them.
"""

from __future__ import annotations

import math
import signal
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict
from functools import partial
from itertools import chain
from multiprocessing import get_context
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from bus.features import FEATURES, WEDGES
from bus.grid import DIRECTIONS, EAST, JUNCTION_TYPES, NORTH, OPPOSITE, SOUTH, WEST, Grid
from modules.classifier.geometry import features_present
from modules.classifier.sensor_model import SensorModel
from modules.detectors.actions import Step, duration_s, ping_offsets_rad, plan
from modules.detectors.interpret import interpret
from scenarios.calibration_kept import Kept
from scenarios.detector_tally import Tally, empty_tally
from simworld.building import Building, build
from simworld.motion import Pose
from simworld.sonar import SonarRing, echoes

NOMINAL_WIDTH_M = 2.0
CRAWL_M_S = 0.085
TURN_RAD_S = math.radians(15.0)
PING_S = 0.96

WIDTHS_M = (1.8, 2.2)
LATERAL_M = 0.1
HEADING_RAD = math.radians(4.0)
"""Trials are uniform over these widths, and to both sides over these errors at the port."""

ODOMETRY_SHARE = 0.02
"""Standard deviation of the true motion as a share of the commanded one (assumption)."""

CORRIDOR_M = 20.0
"""Longer than the sonar reaches, so that a far end never looks like a wall of the junction."""

BYSTANDER_SHARE = 0.1
"""Share of actions during a part of which somebody stands about the junction (assumption). Without
them the detectors hardly ever err in an empty building, and a model made there would be far too
sure of itself among people."""

BYSTANDER_RADIUS_M = 0.25
BYSTANDER_KEEPS_OFF_M = 0.6
"""The least distance between the centres of a bystander and the robot."""

RING = SonarRing()
"""What the trials are run with unless another is given."""

TRIALS_A_TASK = 25
COMMAND = "waywiser calibrate detectors"

_HEADING_RAD = {EAST: 0.0, NORTH: math.pi / 2, WEST: math.pi, SOUTH: -math.pi / 2}


class CalibrationError(ValueError):
    """A calibration that cannot be run."""


def calibrate(
    trials: int,
    seed: int,
    workers: int = 1,
    progress: Callable[[int], None] | None = None,
    ring: SonarRing = RING,
) -> SensorModel:
    """Run the trials and count evidence classes by the truth of X. Raises CalibrationError."""
    return model_of(run_trials(trials, seed, workers, progress, ring), trials, seed, ring)


def run_trials(
    trials: int,
    seed: int,
    workers: int = 1,
    progress: Callable[[int], None] | None = None,
    ring: SonarRing = RING,
    kept: Kept | None = None,
) -> Tally:
    """The sums over all trials, those that were kept taken as they are.

    ``progress`` hears how many trials are done. Raises CalibrationError for no trials or workers,
    KeptError for the kept part of another calibration, OSError where it cannot be written.
    """
    if trials < 1 or workers < 1:
        raise CalibrationError(
            f"expected at least one trial and one worker, got {trials} and {workers}"
        )
    tasks = [range(k, min(k + TRIALS_A_TASK, trials)) for k in range(0, trials, TRIALS_A_TASK)]
    before = kept.done() if kept is not None else []
    total = empty_tally()
    for number, tally in enumerate(chain(before, _run(tasks[len(before) :], seed, workers, ring))):
        if kept is not None and number >= len(before):
            kept.keep(tally)
        total = total.plus(tally)
        if progress is not None:
            progress(tasks[number].stop)
    return total


def model_of(
    tally: Tally, trials: int, seed: int, ring: SonarRing = RING, options: Sequence[str] = ()
) -> SensorModel:
    """The model that the classifier loads; ``options`` are what else the command was given."""
    return SensorModel(
        counts=tally.counts,
        durations_s=durations_s(),
        ring={key: float(value) for key, value in asdict(ring).items()},
        made_by=" ".join([COMMAND, f"--trials {trials} --seed {seed}", *options]),
    )


def kept_part(path: Path, trials: int, seed: int, ring: SonarRing = RING) -> Kept:
    """The finished part of this calibration, kept in a file."""
    return Kept(path, {"trials": trials, "seed": seed, "ring": asdict(ring)})


def durations_s() -> NDArray[np.float64]:
    """How long each detector takes by what it does: (features, wedges)."""
    return np.array(
        [
            [
                round(duration_s(plan(f, w, NOMINAL_WIDTH_M), CRAWL_M_S, TURN_RAD_S, PING_S), 3)
                for w in range(WEDGES)
            ]
            for f in range(len(FEATURES))
        ]
    )


def share_right(model: SensorModel) -> NDArray[np.float64]:
    """Share of trials whose class agrees with X (2, 3 where it holds, 0, 1 where it does not).

    (features, wedges, X); nan where X never had that value.
    """
    right = np.stack([model.counts[..., 0, :2].sum(-1), model.counts[..., 1, 2:].sum(-1)], axis=-1)
    total = model.counts.sum(axis=-1)
    return np.where(total > 0, right / np.maximum(total, 1), np.nan)


def _run(tasks: Sequence[range], seed: int, workers: int, ring: SonarRing) -> Iterator[Tally]:
    """The tally of each task, in order."""
    count = partial(_count, seed=seed, ring=ring)
    if workers == 1 or len(tasks) < 2:
        yield from map(count, tasks)
        return
    pool = ProcessPoolExecutor(workers, get_context("spawn"), _leave_ctrl_c_to_the_parent)
    try:
        yield from pool.map(count, tasks)
    finally:
        pool.shutdown(cancel_futures=True)


def _leave_ctrl_c_to_the_parent() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)


def _count(task: range, seed: int, ring: SonarRing) -> Tally:
    total = empty_tally()
    for number in task:
        total = total.plus(trial(np.random.default_rng([seed, number]), ring))
    return total


def trial(rng: np.random.Generator, ring: SonarRing) -> Tally:
    """One trial: what every detector found, beside the truth of X."""
    heading = int(rng.choice(DIRECTIONS))
    types = [j for j in range(JUNCTION_TYPES) if j & OPPOSITE[heading]]
    junction_type = int(rng.choice(types))
    width_m = float(rng.uniform(*WIDTHS_M))
    building = junction(junction_type, width_m)
    start = at_port(
        building,
        heading,
        lateral_m=float(rng.uniform(-LATERAL_M, LATERAL_M)),
        askew_rad=float(rng.uniform(-HEADING_RAD, HEADING_RAD)),
    )
    truth = features_present(junction_type, heading).astype(np.int64)
    tally = empty_tally()
    offsets_rad = np.array(ping_offsets_rad())
    for f in range(len(FEATURES)):
        for w in range(WEDGES):
            ranges_m = act(plan(f, w, NOMINAL_WIDTH_M), start, building, ring, rng)
            found = interpret(f, w, ranges_m, offsets_rad, NOMINAL_WIDTH_M)
            tally.note(f, w, int(truth[f, w]), found.evidence, found.probability)
    return tally


def junction(junction_type: int, width_m: float) -> Building:
    """A building of nothing but one junction and the corridors it has, its centre at (0, 0)."""
    grid = Grid(3, 3)
    corridors = np.zeros(grid.corridors, dtype=np.uint8)
    for direction in DIRECTIONS:
        corridors[grid.corridor(1, 1, direction)] = bool(junction_type & direction)
    lines_m = (-CORRIDOR_M, 0.0, CORRIDOR_M)
    return build(lines_m, lines_m, corridors, width_m)


def at_port(building: Building, heading: int, lateral_m: float, askew_rad: float) -> Pose:
    """On the port line, ``lateral_m`` to the left of the axis, turned ``askew_rad`` to the left."""
    axis = _HEADING_RAD[heading]
    back_m = -building.corridor_width_m / 2
    return Pose(
        back_m * math.cos(axis) - lateral_m * math.sin(axis),
        back_m * math.sin(axis) + lateral_m * math.cos(axis),
        axis + askew_rad,
    )


def act(
    steps: Sequence[Step],
    start: Pose,
    building: Building,
    ring: SonarRing,
    rng: np.random.Generator,
    bystander_share: float = BYSTANDER_SHARE,
) -> NDArray[np.float64]:
    """The echoes of an action whose motions err: (pings, transducers), nan for none."""
    poses = ping_poses(steps, start, rng)
    people: list[tuple[tuple[float, float, float], ...]] = [()] * len(poses)
    if rng.random() < bystander_share:
        first, last = np.sort(rng.integers(0, len(poses), size=2, endpoint=True))
        people[first:last] = [bystander(building, poses[0], rng)] * (last - first)
    return np.array(
        [
            echoes(ring, building, pose.x_m, pose.y_m, pose.heading_rad, rng, who)
            for pose, who in zip(poses, people, strict=True)
        ]
    )


def moved(pose: Pose, kind: str, amount: float) -> Pose:
    """The pose after a true motion: ``kind`` drive or turn."""
    return pose.after(amount) if kind == "drive" else pose.after(0.0, amount)


def ping_poses(steps: Sequence[Step], start: Pose, rng: np.random.Generator) -> list[Pose]:
    """Where the body truly is at each ping."""
    pose = start
    poses = []
    for step in steps:
        if step.kind == "ping":
            poses += [pose] * int(step.amount)
        else:
            pose = moved(pose, step.kind, step.amount * float(rng.normal(1.0, ODOMETRY_SHARE)))
    return poses


def bystander(
    building: Building, robot: Pose, rng: np.random.Generator
) -> tuple[tuple[float, float, float], ...]:
    """Somebody within three half widths of the junction's centre, clear of walls and robot."""
    reach_m = 1.5 * building.corridor_width_m
    while True:
        x_m, y_m = (float(v) for v in rng.uniform(-reach_m, reach_m, size=2))
        off_m = math.hypot(x_m - robot.x_m, y_m - robot.y_m)
        if off_m >= BYSTANDER_KEEPS_OFF_M and building.clearance_m(x_m, y_m) >= BYSTANDER_RADIUS_M:
            return ((x_m, y_m, BYSTANDER_RADIUS_M),)
