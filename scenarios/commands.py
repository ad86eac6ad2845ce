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
    "`waywiser launch aces --set compute.profile=huey-1990 --log slow.mcap`. "
    "Exit status: 0 good, 1 an expectation does not hold, 2 bad input, 3 inconclusive."
)
def launch(
    scenario: Annotated[str, typer.Argument(help="A shipped scenario's name or a TOML file.")],
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
    """Run a scenario: start every process, show progress, leave one MCAP log."""
    from scenarios.launching import launch_command

    raise typer.Exit(launch_command(scenario, seed, in_process, log, change or [], as_json))


@app.command(
    epilog="Examples: `waywiser analyse logs/runs/aces-seed1-20260101-120000.mcap`; "
    "`waywiser analyse run.mcap --html run.html`. "
    "Exit status: 0 all in time, 1 decisions late, 2 bad input, 3 the log is not whole."
)
def analyse(
    logs: Annotated[list[Path], typer.Argument(metavar="LOG...", help="Logs of runs.")],
    html: Annotated[
        Path | None, typer.Option(help="Also draw the first log as one HTML page.")
    ] = None,
    as_json: Json = False,
) -> None:
    """Say which decisions of a run were late, by how much and why."""
    from scenarios.analysing import analyse_command

    raise typer.Exit(analyse_command(logs, html, as_json))


@calibrate.command("detectors")
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


@calibrate.command("compute")
def calibrate_compute(
    scenario: Annotated[str, typer.Option(help="The scenario whose work is timed.")] = "aces",
    out: Annotated[Path | None, typer.Option(help="Default: the file of profile host.")] = None,
) -> None:
    """Measure what each kind of work takes on this machine: the profile host."""
    from scenarios.calibrating import compute_command

    raise typer.Exit(compute_command(scenario, out))
