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


@app.command(
    epilog="Examples: `waywiser launch aces`; `waywiser launch office-4x4 --seed 7 --in-process`; "
    "`waywiser launch aces --set compute.profile=huey-1990 --log slow.mcap`; "
    "`waywiser launch` alone lists the shipped scenarios. "
    "Exit status: 0 good, 1 an expectation does not hold, 2 bad input, 3 inconclusive."
)
def launch(
    scenario: Annotated[
        str | None, typer.Argument(help="A shipped scenario's name or a TOML file.")
    ] = None,
    seed: Annotated[int | None, typer.Option(min=0, help="Instead of the scenario's own.")] = None,
    in_process: Annotated[
        bool, typer.Option("--in-process", help="Run everything in one process; same log.")
    ] = False,
    log: Annotated[
        str | None, typer.Option(help="Where the log goes; default logs/runs/NAME-seedN-TIME.mcap.")
    ] = None,
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
    epilog="Examples: `waywiser analyse logs/runs/aces-seed1-20260101-120000.mcap`; "
    "`waywiser analyse run.mcap --html run.html --perfetto run.json`; "
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
            help="Also write ledger, spans, topics, chains and beliefs as CSV files (CSV only: "
            "data frame libraries read it, and it needs none).",
        ),
    ] = None,
    perfetto: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE", help="Also write the first log as a trace for https://ui.perfetto.dev."
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


@calibrate.command(
    "detectors", epilog="Example: `waywiser calibrate detectors --trials 200 --out rough.json`."
)
def calibrate_detectors(
    trials: Annotated[int, typer.Option(min=1, help="Random junctions to try.")] = 4000,
    seed: Annotated[int, typer.Option(min=0)] = 1,
    out: Annotated[
        Path | None, typer.Option(help="Default: the file the classifier loads.")
    ] = None,
) -> None:
    """Determine Pr(S|X) by simulated trials of every detector."""
    from scenarios.calibrating import detectors_command

    raise typer.Exit(detectors_command(trials, seed, out))


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
