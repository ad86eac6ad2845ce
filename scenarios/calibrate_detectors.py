"""Determine experimentally what readings are worth: Pr(S|X) for every detector.

The paper (section 3) determines these numbers by experiment; here the experiment is simulated.
A trial is one junction of random type, entered by a random heading in a corridor of random width,
a little off the axis and askew, some walls with doors, where a body whose odometry errs looks once
from every view.
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

from bus.features import FEATURES, USUAL, Wedges
from bus.grid import DIRECTIONS, JUNCTION_TYPES, OPPOSITE
from modules.classifier.sensor_model import SensorModel
from modules.detectors.actions import Step, duration_s, ping_offsets_rad, plan
from modules.detectors.interpret import Seen, finding, see
from modules.detectors.views import View, view_of
from scenarios.calibration_kept import Kept
from scenarios.detector_tally import Tally, empty_tally
from scenarios.trial_junction import at_port, bystander, doorway, jambs, junction
from simworld.building import Building
from simworld.motion import Pose
from simworld.sonar import SonarRing, echoes

NOMINAL_WIDTH_M = 2.0
CRAWL_M_S = 0.085
TURN_RAD_S = math.radians(15.0)
PING_S = 0.96

WIDTHS_M = (1.8, 2.2)
ALONG_M = 0.1
LATERAL_M = 0.1
HEADING_RAD = math.radians(4.0)
"""Trials are uniform over these widths, and to both sides over these errors at the port."""

ODOMETRY_SHARE = 0.02
"""Standard deviation of the true motion as a share of the commanded one (assumption)."""

BYSTANDER_SHARE = 0.1
"""Share of actions during a part of which somebody stands about the junction (assumption). Without
them the detectors hardly ever err in an empty building, and a model made there would be far too
sure of itself among people."""

RING = SonarRing()
"""What the trials are run with unless another is given."""

TRIALS_A_TASK = 25
COMMAND = "waywiser calibrate detectors"


class CalibrationError(ValueError):
    """A calibration that cannot be run."""


def calibrate(
    trials: int,
    seed: int,
    workers: int = 1,
    progress: Callable[[int], None] | None = None,
    ring: SonarRing = RING,
    wedges: Wedges = USUAL,
) -> SensorModel:
    """Run the trials and count evidence classes by the truth of X. Raises CalibrationError."""
    tally = run_trials(trials, seed, workers, progress, ring, wedges=wedges)
    return model_of(tally, trials, seed, ring)


def run_trials(
    trials: int,
    seed: int,
    workers: int = 1,
    progress: Callable[[int], None] | None = None,
    ring: SonarRing = RING,
    kept: Kept | None = None,
    wedges: Wedges = USUAL,
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
    total = empty_tally(wedges)
    left = _run(tasks[len(before) :], seed, workers, ring, wedges)
    for number, tally in enumerate(chain(before, left)):
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
        durations_s=durations_s(tally.wedges),
        ring={key: float(value) for key, value in asdict(ring).items()},
        made_by=" ".join([COMMAND, f"--trials {trials} --seed {seed}", *options]),
    )


def kept_part(
    path: Path, trials: int, seed: int, ring: SonarRing = RING, wedges: Wedges = USUAL
) -> Kept:
    """The finished part of this calibration, kept in a file."""
    head = {"trials": trials, "seed": seed, "ring": asdict(ring), "wedges": wedges.count}
    return Kept(path, head, wedges)


def durations_s(wedges: Wedges = USUAL) -> NDArray[np.float64]:
    """How long each detector takes by what it does: (features, wedges)."""
    taken = np.empty((len(FEATURES), wedges.count))
    for f, w in np.ndindex(taken.shape):
        steps = plan(f, w, NOMINAL_WIDTH_M, wedges)
        taken[f, w] = round(duration_s(steps, CRAWL_M_S, TURN_RAD_S, PING_S), 3)
    return taken


def share_right(model: SensorModel) -> NDArray[np.float64]:
    """Share of trials whose class agrees with X (2, 3 where it holds, 0, 1 where it does not).

    (features, wedges, X); nan where X never had that value.
    """
    right = np.stack([model.counts[..., 0, :2].sum(-1), model.counts[..., 1, 2:].sum(-1)], axis=-1)
    total = model.counts.sum(axis=-1)
    return np.where(total > 0, right / np.maximum(total, 1), np.nan)


def _run(
    tasks: Sequence[range], seed: int, workers: int, ring: SonarRing, wedges: Wedges
) -> Iterator[Tally]:
    """The tally of each task, in order."""
    count = partial(_count, seed=seed, ring=ring, wedges=wedges)
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


def _count(task: range, seed: int, ring: SonarRing, wedges: Wedges) -> Tally:
    total = empty_tally(wedges)
    for number in task:
        total = total.plus(trial(np.random.default_rng([seed, number]), ring, wedges))
    return total


def trial(rng: np.random.Generator, ring: SonarRing, wedges: Wedges = USUAL) -> Tally:
    """One trial: what every detector found, beside the truth of X.

    Detectors that share a view share its echoes.
    """
    heading = int(rng.choice(DIRECTIONS))
    types = [j for j in range(JUNCTION_TYPES) if j & OPPOSITE[heading]]
    junction_type = int(rng.choice(types))
    width_m = float(rng.uniform(*WIDTHS_M))
    doors = jambs(junction_type, heading, rng)
    doorways = [doorway(at, heading, width_m, rng) for at, there in doors.items() if there]
    building = junction(junction_type, width_m, doorways)
    start = at_port(
        building,
        heading,
        lateral_m=float(rng.uniform(-LATERAL_M, LATERAL_M)),
        askew_rad=float(rng.uniform(-HEADING_RAD, HEADING_RAD)),
        along_m=float(rng.uniform(-ALONG_M, ALONG_M)),
    )
    tally = empty_tally(wedges)
    offsets_rad = np.array(ping_offsets_rad())
    seen: dict[View, Seen] = {}
    for f, w in np.ndindex(len(FEATURES), wedges.count):
        view, place = view_of(f, w, wedges), wedges.place(f, w)
        if view not in seen:
            steps = plan(f, w, NOMINAL_WIDTH_M, wedges)
            ranges_m = act(steps, start, building, ring, rng)
            seen[view] = see(view, ranges_m, offsets_rad, NOMINAL_WIDTH_M)
        found = finding(f, seen[view])
        shown = place.shows(f, junction_type, heading) if place is not None else False
        x = doors[place] if place is not None and shown is None else shown
        tally.note(f, w, int(bool(x)), found.evidence, found.probability)
    return tally


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
