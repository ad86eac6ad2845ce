"""Instances of the Canadian Traveller's Problem, as files of the AAAI-10 format."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from modules.decider.roads import Roads


class InstanceError(ValueError):
    """An instance that cannot be read: file, line, what was found, what was expected."""


@dataclass(frozen=True)
class Instance:
    """A graph whose edges are free independently; from vertex 0 to the last."""

    vertices: int
    ends: NDArray[np.int64]
    """(edges, 2): vertices, counted from 0."""
    probability: NDArray[np.float64]
    """(edges,): that each is free."""
    cost: NDArray[np.float64]
    """(edges,): of going along each."""

    @property
    def goal(self) -> int:
        """The vertex to reach."""
        return self.vertices - 1

    def roads(self) -> Roads:
        """The graph for the kernels."""
        return graph(self.vertices, self.ends, self.cost)


def graph(vertices: int, ends: NDArray[np.int64], cost: NDArray[np.float64]) -> Roads:
    """Any graph for the kernels: the edges of a vertex in their order, -1 where it has no more."""
    degree = np.bincount(ends.ravel(), minlength=vertices)
    edges = np.full((vertices, int(degree.max(initial=1))), -1, dtype=np.int64)
    neighbour = np.full_like(edges, -1)
    used = [0] * vertices
    for number, (a, b) in enumerate(ends.tolist()):
        for vertex, other in ((a, b), (b, a)):
            edges[vertex, used[vertex]] = number
            neighbour[vertex, used[vertex]] = other
            used[vertex] += 1
    seconds = np.array(cost, dtype=np.float64)
    return Roads(edges, neighbour, seconds, 2.0 * float(sum(seconds.tolist())))


def read_instance(path: Path) -> Instance:
    """Read a file of one line ``p VERTICES EDGES`` and a line ``e FROM TO P(FREE) COST`` an edge.

    Vertices count from 1; the first is the start, the last the goal. Raises
    :class:`InstanceError`, and OSError where the file cannot be read.
    """
    vertices, edges = 0, -1
    rows: list[tuple[int, int, float, float]] = []
    seen: dict[tuple[int, int], int] = {}
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except UnicodeDecodeError as error:
        raise InstanceError(f"{path}: byte {error.start} is not text, expected UTF-8") from None
    for number, line in enumerate(lines, start=1):
        words = line.split()
        at = f"{path}:{number}"
        if not words or words[0] == "c":
            continue
        if words[0] == "p" and edges < 0:
            vertices, edges = _head(at, words)
        elif words[0] == "e" and edges >= 0:
            row = _edge(at, words, vertices)
            pair = (min(row[:2]), max(row[:2]))
            if pair in seen:
                raise InstanceError(
                    f"{at}: edge {words[1]} {words[2]} again, expected once (line {seen[pair]})"
                )
            seen[pair] = number
            rows.append(row)
        else:
            wanted = "e FROM TO P COST" if edges >= 0 else "p VERTICES EDGES"
            raise InstanceError(f"{at}: found {line.strip()!r}, expected {wanted!r}")
    if edges < 0:
        raise InstanceError(f"{path}: no line 'p VERTICES EDGES'")
    if len(rows) != edges:
        raise InstanceError(f"{path}: {len(rows)} edges, expected {edges} as its first line says")
    table = np.array(rows, dtype=np.float64).reshape(-1, 4)
    return Instance(vertices, table[:, :2].astype(np.int64), table[:, 2], table[:, 3])


def _head(at: str, words: list[str]) -> tuple[int, int]:
    if len(words) != 3 or not all(word.isdecimal() for word in words[1:]):
        raise InstanceError(f"{at}: found {' '.join(words)!r}, expected 'p VERTICES EDGES'")
    vertices, edges = int(words[1]), int(words[2])
    if vertices < 2 or edges < 1:
        raise InstanceError(
            f"{at}: {vertices} vertices and {edges} edges, expected at least 2 and 1"
        )
    return vertices, edges


def _edge(at: str, words: list[str], vertices: int) -> tuple[int, int, float, float]:
    try:
        _, a, b, p, c = words
        start, end, probability, cost = int(a), int(b), float(p), float(c)
    except ValueError:
        raise InstanceError(
            f"{at}: found {' '.join(words)!r}, expected 'e FROM TO P COST'"
        ) from None
    for vertex in (start, end):
        if not 1 <= vertex <= vertices:
            raise InstanceError(f"{at}: vertex {vertex}, expected 1..{vertices}")
    if start == end:
        raise InstanceError(f"{at}: an edge from {start} to itself, expected two vertices")
    if not 0.0 <= probability <= 1.0:
        raise InstanceError(f"{at}: probability {p}, expected 0..1")
    if not 0.0 < cost < np.inf:
        raise InstanceError(f"{at}: cost {c}, expected above 0 and finite")
    return start - 1, end - 1, probability, cost
