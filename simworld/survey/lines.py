"""From upright ways to grid lines: which ways lie on one line, and where that is."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from simworld.survey.net import Net, Way, groups
from simworld.survey.straighten import runs_east


@dataclass(frozen=True)
class Lines:
    """Grid lines and who lies on which: ``column`` and ``row`` are by place number."""

    columns_m: tuple[float, ...]
    rows_m: tuple[float, ...]
    column: dict[int, int]
    row: dict[int, int]


def grid_lines(net: Net, gap_m: float) -> Lines:
    """The lines of an upright net; parallel lines less than ``gap_m`` apart are one.

    Places joined by a way that runs north are on one column, by a way that runs east on one row.
    A line lies in the middle of its ways, by length; one without ways goes through its place.
    """
    columns_m, column = _axis(net, gap_m, 0, lambda way: not runs_east(way))
    rows_m, row = _axis(net, gap_m, 1, runs_east)
    return Lines(columns_m, rows_m, column, row)


def across_m(way: Way, axis: int) -> float:
    """Where a way lies across its direction: the median of its middle half."""
    points = way.path_m[:, axis]
    quarter = len(points) // 4
    return float(np.median(points[quarter : len(points) - quarter]))


def _axis(
    net: Net, gap_m: float, axis: int, along: Callable[[Way], bool]
) -> tuple[tuple[float, ...], dict[int, int]]:
    ways = [way for way in net.ways if along(way)]
    group_of = groups(net.places, [way.ends for way in ways])
    weighed: dict[int, list[tuple[float, float]]] = {}
    for way in ways:
        weighed.setdefault(group_of[way.ends[0]], []).append((across_m(way, axis), way.length_m))
    for place, group in group_of.items():
        if group not in weighed:
            weighed[group] = [(net.places[place][axis], 0.01)]
    lines_m, line_of = _clustered(weighed, gap_m)
    return lines_m, {place: line_of[group] for place, group in group_of.items()}


def _clustered(
    weighed: dict[int, list[tuple[float, float]]], gap_m: float
) -> tuple[tuple[float, ...], dict[int, int]]:
    """Groups of (coordinate, weight) nearer than the gap become one line, the nearest first."""
    clusters = [([group], list(parts)) for group, parts in sorted(weighed.items())]
    while True:
        clusters.sort(key=lambda cluster: (_mean(cluster[1]), cluster[0]))
        means = [_mean(parts) for _, parts in clusters]
        gaps = [(b - a, k) for k, (a, b) in enumerate(pairwise(means))]
        least, k = min(gaps, default=(gap_m, 0))
        if least >= gap_m:
            break
        (groups, parts), (more_groups, more_parts) = clusters[k], clusters.pop(k + 1)
        clusters[k] = (groups + more_groups, parts + more_parts)
    line_of = {group: k for k, (groups, _) in enumerate(clusters) for group in groups}
    return tuple(means), line_of


def _mean(parts: list[tuple[float, float]]) -> float:
    return sum(at * weight for at, weight in parts) / sum(weight for _, weight in parts)
