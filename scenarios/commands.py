"""What the command line's commands do. Heavy imports wait until a command needs them."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

GOOD, FAILED, BAD_INPUT, INCONCLUSIVE = 0, 1, 2, 3

app = typer.Typer(
    help="A robot that decides by expected value, in the time each decision has.",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode=None,
    context_settings={"help_option_names": ["-h", "--help"]},
    pretty_exceptions_enable=False,
)
calibrate = typer.Typer(
    help="Measure what the detectors' readings are worth, or what computing costs here.",
    no_args_is_help=True,
    rich_markup_mode=None,
)
app.add_typer(calibrate, name="calibrate")

Json = Annotated[
    bool, typer.Option("--json", help="Print one JSON object on standard output, nothing else.")
]
InProcess = Annotated[
    bool, typer.Option("--in-process", help="Run everything in one process; same log.")
]
RunLog = Annotated[
    str | None, typer.Option(help="Where the log goes; default logs/runs/NAME-seedN-TIME.mcap.")
]


@app.command(
    epilog="Examples: `waywiser launch aces`; `waywiser launch office-4x4 --seed 7 --in-process`; "
    "`waywiser launch aces --set compute.profile=huey-1990 --log slow.mcap`; "
    "`waywiser launch familiar-place --set errand.0.due_s=1000`; "
    "`waywiser launch` alone lists the shipped scenarios. "
    "Exit status: 0 good, 1 an expectation does not hold, 2 bad input, 3 inconclusive."
)
def launch(
    scenario: Annotated[
        str | None, typer.Argument(help="A shipped scenario's name or a TOML file.")
    ] = None,
    seed: Annotated[int | None, typer.Option(min=0, help="Instead of the scenario's own.")] = None,
    in_process: InProcess = False,
    log: RunLog = None,
    change: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="KEY=VALUE", help="Change a key of the scenario."),
    ] = None,
    as_json: Json = False,
) -> None:
    """Run a scenario: start every process, show progress, leave one MCAP log.

    A first Ctrl-C ends the run with a whole log, a second one at once.
    """
    from scenarios.launching import launch_command

    raise typer.Exit(launch_command(scenario, seed, in_process, log, change or [], as_json))


@app.command(
    "replay-carmen",
    epilog="Examples: `waywiser replay-carmen robot.log.gz --log robot.mcap`, then "
    "`waywiser analyse robot.mcap` or a viewer; `waywiser replay-carmen robot.log --scenario "
    "robot.toml --until 60`, then change robot.toml and launch it. "
    "Exit status: 0 good, 1 it did not end, 2 bad input, 3 inconclusive.",
)
def replay_carmen(
    recording: Annotated[
        Path,
        typer.Argument(
            metavar="LOG",
            help="A CARMEN log (.log, .log.gz) with FLASER and ODOM lines, poses corrected.",
        ),
    ],
    in_process: InProcess = False,
    log: RunLog = None,
    scenario: Annotated[
        Path | None, typer.Option(metavar="TOML", help="Also write the scenario that is run.")
    ] = None,
    until: Annotated[
        float | None, typer.Option(metavar="S", help="Play back only so many seconds.")
    ] = None,
    door_stub: Annotated[
        float,
        typer.Option(metavar="M", help="Ways that lead nowhere are doors or rooms up to so far."),
    ] = 10.0,
    as_json: Json = False,
) -> None:
    """Play back what a real robot sensed: its scans as pings, its odometry, at the log's times.

    The processes hear it as they hear the simulated robot; where it was is the truth of the log.
    """
    from scenarios.recorded import Asked, replay_carmen_command

    asked = Asked(recording, scenario, until, door_stub)
    raise typer.Exit(replay_carmen_command(asked, in_process, log, as_json))


@app.command(
    epilog="Examples: `waywiser analyse logs/runs/aces-seed1-20260101-120000.mcap`; "
    "`waywiser analyse run.mcap --html run.html --perfetto run.pftrace`; "
    "`waywiser analyse a.mcap b.mcap --tables tables`. "
    "Exit status: 0 all in time, 1 decisions late, 2 bad input, 3 the log is not whole."
)
def analyse(
    logs: Annotated[list[Path], typer.Argument(metavar="LOG...", help="Logs of runs.")],
    html: Annotated[
        Path | None, typer.Option(help="Also draw the first log as one HTML page.")
    ] = None,
    tables: Annotated[
        Path | None,
        typer.Option(
            metavar="DIR",
            help="Also write ledger, spans, topics, chains, paths and beliefs as CSV files (CSV "
            "only: data frame libraries read it, and it needs none).",
        ),
    ] = None,
    perfetto: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="Also write the first log as a trace for https://ui.perfetto.dev (protobuf; such "
            "files are called .pftrace).",
        ),
    ] = None,
    as_json: Json = False,
) -> None:
    """Say which decisions of a run were late, by how much and why.

    Several logs give one row each and the ledger of all together.
    """
    from scenarios.analysing import analyse_command

    raise typer.Exit(analyse_command(logs, html, tables, perfetto, as_json))


@app.command(
    epilog="Example: `waywiser check logs/runs/aces-seed1-20260101-120000.mcap`. "
    "Exit status: 0 whole and readable, 1 something is wrong in it, 2 bad input, "
    "3 something is missing, so no verdict is honest."
)
def check(
    log: Annotated[Path, typer.Argument(metavar="LOG", help="Log of a run.")],
    as_json: Json = False,
) -> None:
    """Say whether a log is whole, and whether the viewers will read it."""
    from scenarios.analysing import check_command

    raise typer.Exit(check_command(log, as_json))


@app.command(
    epilog="Example: `waywiser recover run.mcap whole.mcap`, with run.mcap.tail beside it. "
    "Exit status: 0 the run is all there, 2 bad input, 3 some of it is missing."
)
def recover(
    log: Annotated[Path, typer.Argument(metavar="LOG", help="A log that was not closed.")],
    out: Annotated[Path, typer.Argument(metavar="OUT", help="Where the whole log goes.")],
    as_json: Json = False,
) -> None:
    """Make a whole log of what a run that was killed has left, and say what is missing."""
    from scenarios.recovering import recover_command

    raise typer.Exit(recover_command(log, out, as_json))


@app.command(
    epilog="Examples: `waywiser regress before.mcap after.mcap`; "
    "`waywiser regress before/ after/ --junit regress.xml`; "
    "`waywiser regress after/ --write-baseline aces.jsonl`, then "
    "`waywiser regress aces.jsonl later/`; "
    "`waywiser regress ../old . --measure aces --wall`, both source trees, in turn; "
    "`waywiser regress --self-test`. "
    "Exit status: 0 nothing changed, 1 something did, 2 bad input, "
    "3 no verdict is honest (a log is cut off, a run is missing, wall time is unclear)."
)
def regress(
    sides: Annotated[
        list[Path] | None,
        typer.Argument(
            metavar="BASE NEW", help="Logs, folders of logs, or baselines.", show_default=False
        ),
    ] = None,
    tolerance: Annotated[
        float,
        typer.Option(
            min=0.0, max=50.0, metavar="PERCENT", help="By which work may differ, say 0.5."
        ),
    ] = 0.0,
    wall: Annotated[
        bool, typer.Option("--wall", help="Let wall time fail, too; else it is advice.")
    ] = False,
    measure: Annotated[
        str | None,
        typer.Option(
            metavar="SCENARIO",
            help="BASE and NEW are source trees or Pythons: run SCENARIO with them in turn.",
        ),
    ] = None,
    change: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="KEY=VALUE", help="Change a key of that scenario."),
    ] = None,
    rounds: Annotated[int, typer.Option(min=1, help="Runs of each side.")] = 8,
    most_rounds: Annotated[
        int, typer.Option(min=1, help="More rounds, up to these, if wall time is unclear.")
    ] = 24,
    self_test: Annotated[
        bool,
        typer.Option("--self-test", help="Base against base: this machine's false-alarm rates."),
    ] = False,
    comparisons: Annotated[
        int, typer.Option(min=1, help="Of the self-test; each runs base and new in rounds.")
    ] = 10,
    junit: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Also write the report as JUnit XML.")
    ] = None,
    write_baseline: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Write the runs of BASE as a baseline to commit."),
    ] = None,
    as_json: Json = False,
) -> None:
    """Hold runs against earlier ones: simulated time and work exactly, wall time with care.

    Names the cause of a change in one sentence.
    """
    from scenarios.regressing import Asked, regress_command

    raise typer.Exit(
        regress_command(
            Asked(
                sides=tuple(sides or ()),
                tolerance=tolerance / 100.0,
                wall=wall,
                measure=measure,
                changes=tuple(change or ()),
                rounds=rounds,
                most_rounds=most_rounds,
                self_test=self_test,
                comparisons=comparisons,
                junit=junit,
                write_baseline=write_baseline,
                as_json=as_json,
            )
        )
    )


@app.command(
    "map",
    epilog="Examples: `waywiser map building.yaml`; "
    "`waywiser map building.yaml --picture found.svg --scenario found.toml`, then correct "
    "found.toml by hand and `waywiser launch found.toml --in-process`; "
    "`waywiser map building.yaml --doors doors.yaml --door-stub 6`; "
    "`waywiser map corrected.log.gz --plan built.yaml`. Exit status: 0 good, 2 bad input.",
)
def map_plan(
    source: Annotated[
        Path,
        typer.Argument(
            metavar="MAP",
            help="A ROS map_server map (.yaml), or a CARMEN log with corrected poses "
            "(.log, .log.gz), of which a plan is built first.",
        ),
    ],
    picture: Annotated[
        Path | None, typer.Option(metavar="SVG", help="Also draw what was found over the plan.")
    ] = None,
    scenario: Annotated[
        Path | None, typer.Option(metavar="TOML", help="Also write a scenario ready to launch.")
    ] = None,
    plan: Annotated[
        Path | None,
        typer.Option(metavar="YAML", help="Also write the plan as a map: YAML, with a PGM beside."),
    ] = None,
    door_stub: Annotated[
        float,
        typer.Option(metavar="M", help="Ways that lead nowhere are doors or rooms up to so far."),
    ] = 10.0,
    doors: Annotated[
        Path | None, typer.Option(metavar="YAML", help="Doors to close: a BWI doors.yaml.")
    ] = None,
    as_json: Json = False,
) -> None:
    """Survey a floor plan: junctions, corridors, widths, grid lines.

    Turns the building upright and says how far its junctions lie from the lines.
    """
    from scenarios.surveying import map_command

    raise typer.Exit(map_command(source, picture, scenario, plan, door_stub, doors, as_json))


@app.command(
    epilog="Example: `waywiser diff base.mcap new.mcap`. "
    "Exit status: 0 equal, 1 they differ, 2 bad input, "
    "3 a log is cut off and nothing differs in what is there."
)
def diff(
    base: Annotated[Path, typer.Argument(metavar="LOG", help="Log of the run as it was.")],
    new: Annotated[Path, typer.Argument(metavar="LOG", help="Log of the run as it is now.")],
    as_json: Json = False,
) -> None:
    """Say where two runs part: the first event that differs, who said it, what followed."""
    from scenarios.diffing import diff_command

    raise typer.Exit(diff_command(base, new, as_json))


@app.command(
    epilog="Examples: `waywiser replay run.mcap --module decider`; "
    "`waywiser replay run.mcap --module decider --pdb --until 812.5` debugs the first handler "
    "from 812.5 s on. "
    "Exit status: 0 it says the same, 1 it does not, 2 bad input, "
    "3 the log is not whole and nothing differs in what is there."
)
def replay(
    log: Annotated[Path, typer.Argument(metavar="LOG", help="Log of a run, whole or cut off.")],
    module: Annotated[str, typer.Option(help="Which one: decider, say.")],
    until: Annotated[
        float | None,
        typer.Option(
            min=0, metavar="T", help="Stop before T, in simulated seconds; with --pdb, break there."
        ),
    ] = None,
    pdb: Annotated[
        bool,
        typer.Option("--pdb", help="Break into pdb at the first difference, exception, or at T."),
    ] = False,
    as_json: Json = False,
) -> None:
    """Feed one module what it heard, and compare what it says with the log, bit for bit.

    The module is the one of the working tree: try a change on an old log.
    """
    from scenarios.replaying import replay_command

    raise typer.Exit(replay_command(log, module, until, pdb, as_json))


@calibrate.command(
    "detectors",
    epilog="Examples: `waywiser calibrate detectors --trials 200 --out a.json --html a.html`; "
    "`waywiser calibrate detectors --scenario aces --set world.sonar.specular_limit_deg=42 "
    "--out plaster.json`, then `waywiser launch aces --set world.sonar.specular_limit_deg=42 "
    "--set modules.classifier.sensor_model=plaster.json`; "
    "`waywiser calibrate detectors --wedges 12 --out 12.json`, then `waywiser launch aces --set "
    "sensing.wedges=12 --set modules.classifier.sensor_model=12.json`. "
    "Exit status: 0 good, 2 bad input, 3 stopped; the same command then goes on.",
)
def calibrate_detectors(
    trials: Annotated[int, typer.Option(min=1, help="Random junctions to try.")] = 4000,
    seed: Annotated[int, typer.Option(min=0)] = 1,
    out: Annotated[
        Path | None, typer.Option(help="Default: the file the classifier loads.")
    ] = None,
    html: Annotated[
        Path | None, typer.Option(help="Also write the report as one HTML page.")
    ] = None,
    scenario: Annotated[
        str | None, typer.Option(help="With the sonar ring and the wedges of this scenario.")
    ] = None,
    change: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="KEY=VALUE", help="Change a key of that scenario."),
    ] = None,
    workers: Annotated[
        int | None, typer.Option(min=1, help="Processes; default one a core. Same counts.")
    ] = None,
    wedges: Annotated[
        int | None,
        typer.Option(help="Into how many the circle is divided; default 8. Needs --out."),
    ] = None,
    as_json: Json = False,
) -> None:
    """Determine Pr(S|X) by simulated trials of every detector; report curves and Brier scores."""
    from scenarios.calibrating import DetectorTrials, detectors_command

    asked = DetectorTrials(
        trials, seed, out, html, scenario, tuple(change or ()), workers, wedges, as_json
    )
    raise typer.Exit(detectors_command(asked))


@calibrate.command(
    "compute", epilog="Example: `waywiser calibrate compute --scenario aces --out here.json`."
)
def calibrate_compute(
    scenario: Annotated[str, typer.Option(help="The scenario whose work is timed.")] = "aces",
    out: Annotated[Path | None, typer.Option(help="Default: the file of profile host.")] = None,
) -> None:
    """Measure what each kind of work takes on this machine: the profile host."""
    from scenarios.calibrating import compute_command

    raise typer.Exit(compute_command(scenario, out))
