"""What more time makes of each decision: expected cost against seconds.

    python -m benchmarks.quality_by_time [--seeds 1:3] [--most 60] [--plot docs/quality-by-time.svg]

Questions that whole runs of the shipped scenarios asked are answered again by the fixed-time
procedures, which choose the largest problem whose cells are sure to fit, and by the anytime
variants, which refine until they are stopped; seconds are those of the profile ``huey-1990``.
Excess is what the answer costs above the best one, by the expected costs of the largest problem:
64 hypotheses for each junction type, plans of three tests, all eight acts. A procedure whose
smallest problem does not fit has the answer to begin with: the shortest consistent way, concluding
at once, going on with what is being done. Simulated costs only: the numbers repeat anywhere.
"""

from __future__ import annotations

import argparse
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from benchmarks.days import KINDS, Progress, seeds_of
from benchmarks.questions import Meeting, Questions, asked_in_runs, spread
from bus.costs import HUEY_CELL_NS, HUEY_COMPILED_NS, CostModel, WhyStopped
from modules.classifier import anytime as sensing
from modules.classifier.choose import STOP, Problem
from modules.classifier.worth import LOOK_AHEAD, Best, worth
from modules.decider import LADDER, Decision, Situation, decide, largest_that_fits
from modules.decider import anytime as path
from modules.decider.judging import excess_s
from modules.reactor import anytime as reaction
from modules.reactor.meeting import ACTS
from modules.reactor.react import outlook, utilities
from scenarios.costs import cost_model
from scenarios.scenario import Compute

Answered: TypeAlias = tuple[float, float]
"""The size of the problem solved (0: the answer to begin with), and the excess in seconds."""

Refining: TypeAlias = tuple[float, float, WhyStopped]

SECONDS = {
    "path": (0.01, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0, 240.0),
    "sensing": (0.1, 1.0, 3.0, 10.0, 30.0, 60.0, 240.0, 1000.0, 10_000.0, 100_000.0),
    "reaction": (0.0001, 0.0005, 0.001, 0.003, 0.01, 0.03, 0.1, 0.3),
}


@dataclass(frozen=True)
class Point:
    """What one time allowed comes to, means over the questions."""

    seconds: float
    cells: int
    host_s: float
    size: float
    excess_s: float
    refined_size: float
    refined_excess_s: float
    stopped: Counter[str]


class PathJudge:
    """Answers one path question with fewer hypotheses, and tells what that costs."""

    def __init__(self, situation: Situation) -> None:
        self._situation = situation
        types = situation.grid.junction_types(situation.maps)[:, situation.place]
        self._chance = np.bincount(types, situation.weights, 16)
        self._types = len(np.unique(types))
        self._answers: dict[int, float] = {}

    def fixed(self, cells: int) -> Answered:
        """The answer of the largest problem that fits."""
        s = self._situation
        legs = len(s.waypoints)
        size = largest_that_fits(s.grid, len(s.tasks), self._types, cells, legs) or 0
        if size not in self._answers:
            found = decide(s, size) if size else path.refine(s, 0).decision
            self._answers[size] = self._excess_s(found)
        return size, self._answers[size]

    def refined(self, cells: int) -> Refining:
        """The answer of the anytime variant, and why it stopped."""
        found = path.refine(self._situation, cells)
        return found.hypotheses_per_type, self._excess_s(found.decision), found.stopped

    def _excess_s(self, found: Decision) -> float:
        excess = excess_s(self._situation, found.direction, LADDER[-1])
        judged = np.isfinite(excess)
        return float(np.nansum(excess * self._chance) / max(self._chance[judged].sum(), 1e-12))


class SensingJudge:
    """Answers one sensing question by shorter plans, and tells what that costs."""

    def __init__(self, problem: Problem) -> None:
        self._problem = problem
        self._saved_s = [self._judged(k) for k in range(len(problem.belief))]
        self._cells = {
            ahead: problem.cells_of_beliefs + len(problem.belief) * problem.cells_of_plans(ahead)
            for ahead in LOOK_AHEAD
        }

    def _judged(self, outcome: int) -> NDArray[np.float64]:
        """What each first test saves by the longest plans, and nothing for stopping."""
        p = self._problem
        found = worth(p.states[outcome], p.regret_s, p.detectors[outcome], p.barred, LOOK_AHEAD[-1])
        return np.append(found.saved_s, 0.0)

    def fixed(self, cells: int) -> Answered:
        """The answer of the largest problem that fits."""
        size = max((a for a, bound in self._cells.items() if bound <= cells), default=0)
        nothing = Best(STOP, 0.0, 0)
        outcomes = range(len(self._problem.belief))
        rows = [(self._problem.best(k, size) if size else nothing).row for k in outcomes]
        return size, self._excess_s(rows)

    def refined(self, cells: int) -> Refining:
        """The answer of the anytime variant, and why it stopped."""
        found = sensing.refine(self._problem, cells)
        names = [*self._problem.codes.tolist(), STOP]
        rows = [names.index(code) for code in found.choice.next_detector.tolist()]
        return float(found.look_ahead.mean()), self._excess_s(rows), found.stopped

    def _excess_s(self, rows: Sequence[int]) -> float:
        excess = [saved.max() - saved[row] for saved, row in zip(self._saved_s, rows, strict=True)]
        return float(np.array(excess) @ self._problem.chance)


class ReactionJudge:
    """Answers one encounter with fewer acts weighed, and tells what that costs."""

    def __init__(self, meeting: Meeting) -> None:
        self._meeting = meeting
        outlooks = [outlook(one, meeting.diagram, meeting.sides) for one in meeting.met]
        self._utility = utilities(outlooks, ACTS.index(meeting.doing), meeting.diagram)

    def fixed(self, cells: int) -> Answered:
        """The answer of the largest problem that fits."""
        m = self._meeting
        acts = reaction.acts_within(m.met, cells)
        return acts, self._excess_s(best_of_first(m, acts) if acts else m.doing)

    def refined(self, cells: int) -> Refining:
        """The answer of the anytime variant, and why it stopped."""
        m = self._meeting
        found = reaction.refine(m.met, m.doing, m.diagram, cells, m.sides)
        return found.weighed, self._excess_s(found.act), found.stopped

    def _excess_s(self, act: str) -> float:
        return float(self._utility.max() - self._utility[ACTS.index(act)])


def best_of_first(meeting: Meeting, acts: int) -> str:
    """The best of the first acts of the table and the one being done."""
    doing = ACTS.index(meeting.doing)
    outlooks = [outlook(one, meeting.diagram, meeting.sides) for one in meeting.met]
    utility = utilities(outlooks, doing, meeting.diagram)
    return ACTS[max((*range(acts), doing), key=lambda act: (utility[act], -act))]


Judge: TypeAlias = PathJudge | SensingJudge | ReactionJudge
JUDGES: dict[str, Callable[[Any], Judge]] = {
    "path": PathJudge,
    "sensing": SensingJudge,
    "reaction": ReactionJudge,
}


def curve(kind: str, judges: Sequence[Judge], costs: CostModel, host: CostModel) -> list[Point]:
    """Quality by time allowed for one kind of decision."""
    points = []
    for seconds in SECONDS[kind]:
        cells = costs.cells_within(kind, round(seconds * 1e9))
        fixed = [judge.fixed(cells) for judge in judges]
        refined = [judge.refined(cells) for judge in judges]
        points.append(
            Point(
                seconds,
                cells,
                host.cost_ns(kind, cells) / 1e9,
                float(np.mean([size for size, _ in fixed])),
                float(np.mean([excess for _, excess in fixed])),
                float(np.mean([size for size, _, _ in refined])),
                float(np.mean([excess for _, excess, _ in refined])),
                Counter(why for _, _, why in refined),
            )
        )
    return points


def curves(questions: Questions, most: int) -> dict[str, list[Point]]:
    """The curves of all kinds, each of at most so many questions."""
    costs = cost_model(Compute(profile="huey-1990"))
    host = cost_model(Compute(profile="host"))
    found, progress = {}, Progress(len(KINDS))
    for kind in KINDS:
        judges = [JUDGES[kind](one) for one in spread(getattr(questions, kind), most)]
        found[kind] = curve(kind, judges, costs, host)
        progress.step(kind)
    return found


SIZES = {"path": "hypotheses a type", "sensing": "tests a plan", "reaction": "acts weighed"}
WHY: tuple[WhyStopped, ...] = ("nothing left", "settled", "out of cells")


def print_curve(kind: str, points: Sequence[Point]) -> None:
    print(f"\n{kind}: size is {SIZES[kind]}; excess in expected seconds")
    print(
        f"{'seconds':>9} {'cells':>10} {'host, s':>9} | {'fixed':^16} | "
        f"{'anytime':^16} | why the anytime variant stopped\n"
        f"{'':>30} | {'size':>6} {'excess':>9} | {'size':>6} {'excess':>9} |"
    )
    for p in points:
        why = ", ".join(f"{why} {p.stopped[why]}" for why in WHY if p.stopped[why])
        print(
            f"{p.seconds:>9g} {p.cells:>10} {p.host_s:>9.2g} | {p.size:>6.1f} {p.excess_s:>9.2f} | "
            f"{p.refined_size:>6.1f} {p.refined_excess_s:>9.2f} | {why}"
        )


def plot(found: dict[str, list[Point]], file: Path) -> None:
    """A panel for each kind: excess over the seconds allowed."""
    import matplotlib as mpl

    mpl.use("svg")
    mpl.rcParams["svg.hashsalt"] = "waywiser"  # else the file would differ from run to run
    mpl.rcParams["svg.fonttype"] = "none"
    from matplotlib import pyplot

    figure, panels = pyplot.subplots(1, len(found), figsize=(11.0, 3.6))
    allowed = {"path": (240.0, "a corridor"), "sensing": (30.0, "an action"), "reaction": (0, "")}
    for panel, (kind, points) in zip(panels, found.items(), strict=True):
        seconds = [p.seconds for p in points]
        panel.step(seconds, [p.excess_s for p in points], "o-", where="post", label="fixed time")
        refined = [p.refined_excess_s for p in points]
        panel.step(seconds, refined, "s--", where="post", label="anytime")
        panel.set_xscale("log")
        panel.set_yscale("symlog", linthresh=1.0)
        panel.set_title(kind)
        panel.set_xlabel("seconds of the computer of 1990")
        panel.set_ylim(bottom=0.0)
        panel.grid(alpha=0.3)
        at, name = allowed[kind]
        if at:
            panel.axvline(at, color="0.5", lw=1)
            panel.text(at, panel.get_ylim()[1], f" {name}", fontsize=8, va="top", ha="right")
    panels[0].set_ylabel("expected cost above the best, s")
    panels[-1].legend()
    figure.tight_layout()
    figure.savefig(file, metadata={"Date": None})


def main() -> None:
    parser = argparse.ArgumentParser(
        description="Expected cost of each decision against the seconds it may take.",
        epilog="Example: python -m benchmarks.quality_by_time --plot docs/quality-by-time.svg",
    )
    parser.add_argument("--seeds", default="1:3", help="seeds of the runs, A:B (1:3)")
    parser.add_argument("--most", type=int, default=60, help="questions of each kind (60)")
    parser.add_argument("--plot", type=Path, help="an SVG file to write")
    arguments = parser.parse_args()
    questions = asked_in_runs(seeds_of(arguments.seeds))
    print(
        f"asked: {len(questions.path)} paths, {len(questions.sensing)} features, "
        f"{len(questions.reaction)} reactions; at most {arguments.most} of each are answered"
    )
    found = curves(questions, arguments.most)
    for kind, points in found.items():
        print_curve(kind, points)
    print(
        f"\nA reaction's cells are those of compiled tables ({HUEY_COMPILED_NS / 1e6:g} ms each); "
        f"in a general network ({HUEY_CELL_NS / 1e6:g} ms) each time is "
        f"{HUEY_CELL_NS / HUEY_COMPILED_NS:.0f} times as long."
    )
    if arguments.plot:
        plot(found, arguments.plot)


if __name__ == "__main__":
    main()
