"""The pytest plugin. Light: what runs a scenario is imported by the first test that wants it."""

from __future__ import annotations

import json
import re
from collections.abc import Generator, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from bus.messages import LedgerEntry, MapBelief
    from logs.chains import DecisionChain
    from scenarios.testing.baselines import Baseline
    from scenarios.testing.runs import Run, Runs, Wanted
    from scenarios.testing.store import Store

MARKER = "waywiser"
SEED = "waywiser_seed"
BASELINES = "baselines"
SHOWN = 5
"""Logs that a failure names."""

_store = pytest.StashKey["Store"]()
_used = pytest.StashKey["dict[Path, None]"]()
_updated = "waywiser_updated"


def pytest_addoption(parser: pytest.Parser) -> None:
    """The plugin's options."""
    group = parser.getgroup(MARKER, "deadline tests of scenarios")
    group.addoption(
        "--waywiser-update",
        action="store_true",
        help="write the baselines that tests hold their runs against",
    )
    group.addoption(
        "--waywiser-logs",
        metavar="DIR",
        help="leave the logs of all runs here (default: those of failures, in a temporary folder)",
    )


def pytest_configure(config: pytest.Config) -> None:
    """Make the marker known."""
    config.addinivalue_line(
        "markers",
        f"{MARKER}(scenario, seeds=None, set={{}}): run a scenario (a shipped one's name or a TOML "
        "file) in this process, once for each seed, with these keys changed; the fixtures runs, "
        "run, ledger, beliefs and chains have what became of it",
    )


class _Marked:
    """What a test's marker asks for."""

    def __init__(self, scenario: str | Path, seeds: Any = None, set: Any = None) -> None:
        self.scenario = str(scenario)
        self.changes = tuple(f"{key}={json.dumps(value)}" for key, value in (set or {}).items())
        self.seeds: tuple[int | None, ...] = (
            (seeds,) if seeds is None or isinstance(seeds, int) else tuple(seeds)
        )

    def wanted(self, seed: int | None) -> Wanted:
        from scenarios.testing.runs import Wanted

        return Wanted(self.scenario, seed, self.changes)


def _marked(item: pytest.Item) -> _Marked:
    marker = item.get_closest_marker(MARKER)
    if marker is None:
        pytest.fail(f'expected @pytest.mark.{MARKER}("SCENARIO") on the test', pytrace=False)
    try:
        return _Marked(*marker.args, **marker.kwargs)
    except TypeError as error:
        refused = str(error)
    pytest.fail(f"{item.nodeid}: @pytest.mark.{MARKER}: {refused}", pytrace=False)


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """A test of one ``run`` becomes a test for each seed, so that workers share them."""
    marker = metafunc.definition.get_closest_marker(MARKER)
    if marker is not None and SEED in metafunc.fixturenames:
        seeds = _marked(metafunc.definition).seeds
        metafunc.parametrize(SEED, seeds, ids=[f"seed{seed}" for seed in seeds])


@pytest.fixture(scope="session")
def waywiser_store(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[Store]:
    """The runs of this session, or of this worker of it."""
    from scenarios.testing.store import Store

    wanted = request.config.getoption("--waywiser-logs")
    folder = Path(wanted) / _worker(request.config) if wanted else tmp_path_factory.mktemp(MARKER)
    folder.mkdir(parents=True, exist_ok=True)
    store = Store(folder, keep_all=bool(wanted))
    request.config.stash[_store] = store
    yield store
    store.close()


def _worker(config: pytest.Config) -> str:
    """The name of this worker under xdist, else nothing."""
    return str(getattr(config, "workerinput", {}).get("workerid", ""))


def _run(request: pytest.FixtureRequest, store: Store, seed: int | None) -> Run:
    from logs.run_log import LogWriteError
    from scenarios.modules import ModuleRefusedError
    from scenarios.scenario import ScenarioError

    wanted = _marked(request.node).wanted(seed)
    try:
        run = store.run(wanted)
    except (ScenarioError, ModuleRefusedError, LogWriteError) as error:
        refused = str(error)
    else:
        request.node.stash.setdefault(_used, {})[run.log] = None
        return run
    pytest.fail(f"@pytest.mark.{MARKER}: {refused}", pytrace=False)


@pytest.fixture
def runs(request: pytest.FixtureRequest, waywiser_store: Store) -> Runs:
    """The finished runs of the test's scenario, one for each of its marker's seeds."""
    from scenarios.testing.runs import Runs

    return Runs([_run(request, waywiser_store, seed) for seed in _marked(request.node).seeds])


@pytest.fixture(name=SEED)
def _waywiser_seed(request: pytest.FixtureRequest) -> int | None:
    """The seed of ``run``; parametrised by the marker."""
    (seed,) = _marked(request.node).seeds
    return seed


@pytest.fixture
def run(request: pytest.FixtureRequest, waywiser_store: Store, waywiser_seed: int | None) -> Run:
    """One finished run; the test is repeated for each of its marker's seeds."""
    return _run(request, waywiser_store, waywiser_seed)


@pytest.fixture
def ledger(run: Run) -> tuple[LedgerEntry, ...]:
    """What became of each decision of ``run``."""
    return run.ledger


@pytest.fixture
def beliefs(run: Run) -> tuple[MapBelief, ...]:
    """What the geographer of ``run`` believed of the map, in the order of time."""
    return run.beliefs


@pytest.fixture
def chains(run: Run) -> tuple[DecisionChain, ...]:
    """What led to each decision of ``run``, the one with the least slack first."""
    return run.chains


@pytest.fixture
def baseline(request: pytest.FixtureRequest) -> Baseline:
    """The baselines beside the test's file, in the folder ``baselines``."""
    from scenarios.testing.baselines import Baseline

    def updated(path: Path) -> None:
        request.node.user_properties.append((_updated, str(path)))

    return Baseline(
        request.path.parent / BASELINES,
        re.sub(r"[^\w.-]+", "-", request.node.name).strip("-"),
        request.config.getoption("--waywiser-update"),
        updated,
    )


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(
    item: pytest.Item,
) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    """A failed test says how to open the logs of its runs, and they stay."""
    report = yield
    used = item.stash.get(_used, {})
    if report.failed and used:
        from scenarios.testing.deadlines import how_to_open

        store = item.config.stash[_store]
        for log in used:
            store.keep(log)
        lines = [how_to_open(log) for log in list(used)[:SHOWN]]
        if len(used) > SHOWN:
            lines.append(f"and {len(used) - SHOWN} more beside it")
        report.sections.append(("logs of its runs", "\n".join(lines)))
    return report


def pytest_terminal_summary(terminalreporter: Any) -> None:
    """Say which baselines were written: they want to be reviewed."""
    paths = [
        value
        for report in terminalreporter.getreports("passed")
        for key, value in report.user_properties
        if key == _updated
    ]
    if paths:
        terminalreporter.section("baselines written; review them as any change (git diff)")
        for path in dict.fromkeys(paths):
            terminalreporter.line(path)
