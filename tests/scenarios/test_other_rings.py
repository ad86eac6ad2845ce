"""A whole encounter of a robot that carries another ring."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from bus.messages import LedgerEntry, ReactionDecision, RunEnded, Sonar, TrueEncounter
from modules.classifier.sensor_model import SHIPPED
from scenarios.modules import ModuleRefusedError
from scenarios.scenario import ScenarioError
from tests.scenarios.runs import everything_said, of_kind, shipped


def with_ring(transducers: int, half_angle_deg: float, folder: Path) -> tuple[str, ...]:
    """What to change in a scenario; the shipped sensor model stands for that ring's own."""
    model = json.loads(SHIPPED.read_text(encoding="utf-8"))
    radians = half_angle_deg * 3.141592653589793 / 180.0
    model["ring"] |= {"transducers": float(transducers), "half_angle_rad": radians}
    path = folder / "model.json"
    path.write_text(json.dumps(model), encoding="utf-8")
    return (
        f"world.sonar.transducers={transducers}",
        f"world.sonar.half_angle_deg={half_angle_deg}",
        f"modules.classifier.sensor_model={path}",
    )


@pytest.mark.parametrize(("transducers", "half_angle_deg"), [(16, 20.0), (36, 10.0), (48, 7.5)])
@pytest.mark.parametrize("name", ["person-does-not-yield", "box-put-down"])
def test_an_encounter_ends_well_with_another_ring(
    name: str, transducers: int, half_angle_deg: float, tmp_path: Path
) -> None:
    changes = with_ring(transducers, half_angle_deg, tmp_path)
    said = everything_said(shipped(name, *changes).scenario)
    assert of_kind(said, RunEnded)[-1].reason == "done"
    assert len(of_kind(said, Sonar)[0].ranges_m) == transducers
    assert [met.collided for met in of_kind(said, TrueEncounter)] == [False]
    assert not any(entry.cause for entry in of_kind(said, LedgerEntry))
    assert any(one.act != "continue" for one in of_kind(said, ReactionDecision))


def test_a_ring_that_does_not_see_ahead_is_refused(tmp_path: Path) -> None:
    changes = with_ring(8, 15.0, tmp_path)
    with pytest.raises(ModuleRefusedError, match=r"reactor: found a ring of 8 .* expected 3"):
        everything_said(shipped("person-does-not-yield", *changes).scenario)


def test_a_false_echo_of_no_transducer_of_the_ring_is_refused(tmp_path: Path) -> None:
    changes = with_ring(16, 20.0, tmp_path)
    with pytest.raises(ScenarioError, match=r"false_echo\[0\].transducers: found 23, .* 0 to 15"):
        everything_said(shipped("false-echo", *changes).scenario)
