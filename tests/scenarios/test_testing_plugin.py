"""The pytest plugin: what a user's tests see, run by pytest within pytest."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

from logs.binomial import lower_bound
from scenarios.testing.baselines import Baseline
from scenarios.testing.durations import seconds
from scenarios.testing.runs import Wanted, run_wanted

HEAD = """\
import pytest
SHORT = {"world.until_s": 200}
LATE = {"world.until_s": 300, "compute.slower.sensing": 60.0}
"""


@pytest.fixture(scope="module", autouse=True)
def _all_is_loaded(tmp_path_factory: pytest.TempPathFactory) -> None:
    """Pytest forgets what the inner one has imported, and numba does not bear being loaded twice.

    So all that a run and its baseline need is loaded before.
    """
    wanted = Wanted("aces", 1, ("world.until_s=100",))
    run = run_wanted(wanted, tmp_path_factory.mktemp("first") / "first.mcap")
    Baseline(run.log.parent, "none", True, lambda _: None).holds([run])
    assert lower_bound(1, 2, 0.95) > 0.0


def write(pytester: pytest.Pytester, text: str) -> None:
    pytester.makepyfile(test_it=HEAD + text)


def run(pytester: pytest.Pytester, *words: str) -> pytest.RunResult:
    # hypothesis would be imported again, and take seconds, each time
    return pytester.runpytest_inprocess("--strict-markers", "-p", "no:hypothesispytest", *words)


def output(result: pytest.RunResult) -> str:
    return result.stdout.str()


def test_runs_over_seeds_and_one_run_a_seed(pytester: pytest.Pytester) -> None:
    write(
        pytester,
        """
@pytest.mark.waywiser("aces", seeds=[1, 2], set=SHORT)
def test_all(runs):
    assert [run.seed for run in runs] == [1, 2]
    assert {run.ended for run in runs} == {"time"}
    assert runs.deadlines("path").all_met()
    assert runs.deadlines().slack_at_least("5 s")
    assert runs.deadlines("sensing").met_with(0.5)

@pytest.mark.waywiser("aces", seeds=range(1, 3), set=SHORT)
def test_each(run, ledger, beliefs, chains):
    assert run.deadlines("path").all_met()
    assert ledger and beliefs and {c.decision for c in chains} == {e.decision for e in ledger}

@pytest.mark.waywiser("aces", set=SHORT)
def test_own_seed(run):
    assert run.seed == 1
""",
    )
    result = run(pytester, "-v")
    result.assert_outcomes(passed=4)
    assert re.findall(r"test_each\[(\w+)\]", output(result)) == ["seed1", "seed2"]


def test_a_failure_shows_the_worst_decision_and_how_to_open_its_log(
    pytester: pytest.Pytester,
) -> None:
    write(
        pytester,
        """
@pytest.mark.waywiser("aces", seeds=[3, 4], set=LATE)
def test_late(runs):
    runs.deadlines("sensing").all_met()

@pytest.mark.waywiser("aces", seeds=[3], set=SHORT)
def test_good(runs):
    assert len(runs) == 1
""",
    )
    result = run(pytester)
    result.assert_outcomes(failed=1, passed=1)
    text = output(result)
    assert re.search(r"sensing decisions in 2 runs were late", text)
    assert re.search(r"worst: sensing \d+ \(visit \d+\) of seed [34]: asked at", text)
    assert "longest: classifier computing asked/sensing, 60.0" in text
    assert "cause: overrun" in text
    (html,) = set(re.findall(r"open it: waywiser analyse (\S+) --html \S+\.html", text))
    assert Path(html).is_file()
    kept = {log.stem.rpartition("-")[0] for log in Path(html).parent.glob("*.mcap")}
    assert kept == {"aces-seed3", "aces-seed4"}
    assert len(list(Path(html).parent.glob("*.mcap"))) == 2  # that of the good test is gone


@pytest.mark.parametrize(
    "assertion, told",
    [
        ('deadlines("path").slack_at_least("10 min")', "had less slack than 600 s"),
        ('deadlines("path").met_with(0.99)', "without a miss it takes 299 decisions"),
        ('deadlines("reaction").all_met()', "no reaction decision was settled in 1 runs"),
        ('deadlines("pathos")', "found the kind 'pathos', expected one of sensing, path"),
        ('deadlines("path").slack_at_least("5 parsecs")', "found '5 parsecs', expected a number"),
        ('deadlines("path").met_with(1.5)', "expected both within 0 and 1"),
    ],
)
def test_what_does_not_hold_is_told(assertion: str, told: str, pytester: pytest.Pytester) -> None:
    write(
        pytester,
        f"""
@pytest.mark.waywiser("aces", set=SHORT)
def test_it(runs):
    runs.{assertion}
""",
    )
    result = run(pytester)
    result.assert_outcomes(failed=1)
    assert told in output(result)


WITH_BASELINE = """
@pytest.mark.waywiser("aces", seeds=[1], set=dict(SHORT, **{}))
def test_same(runs, baseline):
    assert baseline.holds(runs)
"""


def test_a_baseline_is_written_held_and_its_difference_shown(pytester: pytest.Pytester) -> None:
    write(pytester, WITH_BASELINE)
    result = run(pytester)
    result.assert_outcomes(failed=1)
    assert "write it with pytest --waywiser-update" in output(result)

    result = run(pytester, "--waywiser-update")
    result.assert_outcomes(passed=1)
    path = pytester.path / "baselines" / "test_same.jsonl"
    assert f"{path}" in output(result)
    run(pytester).assert_outcomes(passed=1)

    text = path.read_text()
    path.write_text(re.sub(r'"slack_ns":7', '"slack_ns":8', text, count=1))
    result = run(pytester)
    result.assert_outcomes(failed=1)
    assert "1 decisions changed" in output(result)
    assert re.search(r'-\{"line":"decision".*"slack_ns":8', output(result))
    assert re.search(r'\+\{"line":"decision".*"slack_ns":7', output(result))
    assert run(pytester, "--waywiser-update").ret == 0
    assert path.read_text() == text


def test_a_baseline_of_something_else_is_refused(pytester: pytest.Pytester) -> None:
    write(pytester, WITH_BASELINE)
    run(pytester, "--waywiser-update").assert_outcomes(passed=1)
    write(pytester, WITH_BASELINE.replace("{}", '{"world.speed_m_s": 0.1}'))
    result = run(pytester)
    result.assert_outcomes(failed=1)
    assert "expected the same run, found that these differ" in output(result)


def test_bad_markers_are_told_without_a_traceback(pytester: pytest.Pytester) -> None:
    write(
        pytester,
        """
@pytest.mark.waywiser("acez")
def test_unknown(runs): pass

@pytest.mark.waywiser("aces", set={"world.speed": 3})
def test_key(run): pass

@pytest.mark.waywiser("aces", sedes=3)
def test_word(runs): pass

def test_none(ledger): pass
""",
    )
    result = run(pytester)
    result.assert_outcomes(errors=4)
    text = output(result)
    assert "acez: found no such file" in text
    assert "world.speed: found an unknown key" in text
    assert "sedes" in text
    assert 'expected @pytest.mark.waywiser("SCENARIO") on the test' in text
    assert "Traceback" not in text
    assert "plugin.py" not in text


def test_the_plugin_loads_nothing_heavy() -> None:
    code = (
        "import sys, scenarios.testing.plugin; "
        "print([n for n in ('numpy', 'msgspec', 'simpy', 'scipy') if n in sys.modules])"
    )
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert said.stdout.strip() == "[]"


def test_workers_share_the_seeds_and_the_update(pytester: pytest.Pytester) -> None:
    write(
        pytester,
        """
@pytest.mark.waywiser("aces", seeds=range(1, 4), set={"world.until_s": 100})
def test_each(run, baseline):
    assert baseline.holds([run])
""",
    )
    run(pytester, "--waywiser-update", "-n", "2", "--waywiser-logs", "kept").assert_outcomes(
        passed=3
    )
    written = sorted(path.name for path in (pytester.path / "baselines").iterdir())
    assert written == [f"test_each-seed{seed}.jsonl" for seed in range(1, 4)]
    run(pytester).assert_outcomes(passed=3)
    logs = [path.stem.split("-")[1] for path in (pytester.path / "kept").glob("gw*/*.mcap")]
    assert sorted(logs) == ["seed1", "seed2", "seed3"]


@pytest.mark.parametrize(
    "written, expected",
    [("5 s", 5.0), ("200ms", 0.2), ("4 min", 240.0), ("-1.5 s", -1.5), (3, 3.0), ("1e3 us", 1e-3)],
)
def test_durations(written: str | float, expected: float) -> None:
    assert seconds(written) == pytest.approx(expected)
