"""Reading instances: what is right, and each way to be wrong."""

from __future__ import annotations

from pathlib import Path

import pytest

from modules.decider.traveller import InstanceError, read_instance

SHARED = Path(__file__).parents[3] / "shared" / "benchmarks" / "ctp"
GOOD = "p 3 2\ne 1 2 0.5 7\ne 2 3 1 2.5\n"


def written(folder: Path, text: str) -> Path:
    path = folder / "a.graph"
    path.write_text(text)
    return path


def test_an_instance_is_read_with_vertices_from_zero(tmp_path: Path) -> None:
    instance = read_instance(written(tmp_path, "c a comment\n\n" + GOOD))
    assert (instance.vertices, instance.goal) == (3, 2)
    assert instance.ends.tolist() == [[0, 1], [1, 2]]
    assert instance.probability.tolist() == [0.5, 1.0]
    assert instance.cost.tolist() == [7.0, 2.5]
    roads = instance.roads()
    assert roads.corridor.tolist() == [[0, -1], [0, 1], [1, -1]]
    assert roads.neighbour.tolist() == [[1, -1], [0, 2], [1, -1]]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "a.graph: no line 'p VERTICES EDGES'"),
        ("e 1 2 0.5 7\n", "a.graph:1: found 'e 1 2 0.5 7', expected 'p VERTICES EDGES'"),
        ("p 3\n", "a.graph:1: found 'p 3', expected 'p VERTICES EDGES'"),
        ("p 1 0\n", "a.graph:1: 1 vertices and 0 edges, expected at least 2 and 1"),
        ("p 3 2\np 3 2\n", "a.graph:2: found 'p 3 2', expected 'e FROM TO P COST'"),
        ("p 3 2\ne 1 2 0.5\n", "a.graph:2: found 'e 1 2 0.5', expected 'e FROM TO P COST'"),
        ("p 3 2\ne 1 x 0.5 7\n", "a.graph:2: found 'e 1 x 0.5 7', expected 'e FROM TO P COST'"),
        ("p 3 2\ne 1 4 0.5 7\n", "a.graph:2: vertex 4, expected 1..3"),
        ("p 3 2\ne 1 1 0.5 7\n", "a.graph:2: an edge from 1 to itself, expected two vertices"),
        ("p 3 2\ne 1 2 1.5 7\n", "a.graph:2: probability 1.5, expected 0..1"),
        ("p 3 2\ne 1 2 nan 7\n", "a.graph:2: probability nan, expected 0..1"),
        ("p 3 2\ne 1 2 0.5 0\n", "a.graph:2: cost 0, expected above 0 and finite"),
        ("p 3 2\ne 1 2 0.5 inf\n", "a.graph:2: cost inf, expected above 0 and finite"),
        (
            "p 3 2\ne 1 2 0.5 7\ne 2 1 0.5 7\n",
            "a.graph:3: edge 2 1 again, expected once (line 2)",
        ),
        ("p 3 2\ne 1 2 0.5 7\n", "a.graph: 1 edges, expected 2 as its first line says"),
    ],
)
def test_what_is_wrong_is_named(tmp_path: Path, text: str, said: str) -> None:
    with pytest.raises(InstanceError) as error:
        read_instance(written(tmp_path, text))
    assert str(error.value).endswith(said)


def test_bytes_that_are_no_text_are_named(tmp_path: Path) -> None:
    path = tmp_path / "b.graph"
    path.write_bytes(b"p 3 2\n\xff")
    with pytest.raises(InstanceError, match="byte 6 is not text, expected UTF-8"):
        read_instance(path)


@pytest.mark.skipif(not SHARED.exists(), reason="the graphs of AAAI-10 are not there")
def test_the_published_graphs_are_read() -> None:
    found = [read_instance(SHARED / f"20-{k}.graph") for k in range(1, 11)]
    assert [len(i.cost) for i in found] == [49, 49, 51, 49, 52, 49, 50, 51, 50, 49]
    assert {i.vertices for i in found} == {20}
