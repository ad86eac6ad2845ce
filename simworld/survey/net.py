"""A net of places and ways between them, and what simplifies it.

All functions return a new net; where there is a choice the shortest way comes first, then the
earliest, so that the same plan gives the same net everywhere.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

Point: TypeAlias = tuple[float, float]


@dataclass(frozen=True, eq=False)
class Way:
    """A way between two places: ``path_m`` is (points, 2), from the first end to the second."""

    ends: tuple[int, int]
    path_m: NDArray[np.float64]

    @cached_property
    def length_m(self) -> float:
        """Along the path."""
        return float(np.linalg.norm(np.diff(self.path_m, axis=0), axis=1).sum())

    def reach_m(self, end: int) -> float:
        """How far it gets from its first (0) or last (-1) point, as the crow flies."""
        return float(np.linalg.norm(self.path_m - self.path_m[end], axis=1).max())

    def turned_about(self) -> Way:
        """The same way from the other end."""
        return Way((self.ends[1], self.ends[0]), self.path_m[::-1])


@dataclass(frozen=True, eq=False)
class Net:
    """Places by number, in metres, and the ways between them."""

    places: Mapping[int, Point]
    ways: tuple[Way, ...]

    @cached_property
    def degrees(self) -> Counter[int]:
        """How many ways end at each place; a loop ends there twice."""
        return Counter(end for way in self.ways for end in way.ends)


def pruned(net: Net, stub_m: float) -> Net:
    """The net without ways that lead nowhere, and no further than this: doors, niches, rooms.

    How far is as the crow flies: through a room a way winds. What ends after such a way is gone
    is measured anew, joined to what it continues.
    """
    net = joined(net)
    while True:
        reaches = {k: _stub_m(net, way) for k, way in enumerate(net.ways)}
        shortest = min(reaches, key=lambda k: reaches[k], default=-1)
        if reaches.get(shortest, stub_m) >= stub_m:
            return net
        net = joined(replace(net, ways=net.ways[:shortest] + net.ways[shortest + 1 :]))


def _stub_m(net: Net, way: Way) -> float:
    """How far a way reaches that ends where no other does; infinite for one that leads on."""
    first, last = (net.degrees[end] for end in way.ends)
    if min(first, last) > 1 or max(first, last) == 1:
        return math.inf
    return way.reach_m(0 if last == 1 else -1)


def joined(net: Net, alike: Callable[[Way, Way], bool] = lambda _first, _second: True) -> Net:
    """The net with ways that meet at a place of no others, and are alike, made one way."""
    by_place: dict[int, list[int]] = {}
    ways: dict[int, Way] = dict(enumerate(net.ways))
    for k, way in ways.items():
        for end in way.ends:
            by_place.setdefault(end, []).append(k)
    for place in sorted(by_place):
        numbers = by_place[place]
        if len(numbers) != 2 or numbers[0] == numbers[1]:
            continue
        if not alike(ways[numbers[0]], ways[numbers[1]]):
            continue
        first, second = ways.pop(numbers[0]), ways.pop(numbers[1])
        one = _continued(first, second, place)
        ways[numbers[0]] = one
        by_place[place] = []
        far = one.ends[1]
        by_place[far] = [numbers[0] if k == numbers[1] else k for k in by_place[far]]
    kept = tuple(ways[k] for k in sorted(ways))
    return Net(_still_used(net.places, kept), kept)


def _continued(first: Way, second: Way, place: int) -> Way:
    """Two ways that meet at a place as one."""
    first = first if first.ends[1] == place else first.turned_about()
    second = second if second.ends[0] == place else second.turned_about()
    path = np.concatenate([first.path_m, second.path_m[1:]])
    return Way((first.ends[0], second.ends[1]), path)


def merged(net: Net, too_short: Callable[[Net, Way], bool]) -> Net:
    """The net with the ends of ways that are too short made one place; loops vanish likewise.

    The place lies in the middle, unless one end is a junction and the other is not.
    """
    while True:
        short = [k for k, way in enumerate(net.ways) if too_short(net, way)]
        if not short:
            return net
        shortest = min(short, key=lambda k: net.ways[k].length_m)
        net = _contracted(net, shortest)


def _contracted(net: Net, number: int) -> Net:
    keep, gone = sorted(net.ways[number].ends)
    at = _merged_place(net, keep, gone)
    ways = tuple(_moved_ends(way, gone, keep, at) for k, way in enumerate(net.ways) if k != number)
    return Net(_still_used({**net.places, keep: at}, ways), ways)


def _merged_place(net: Net, a: int, b: int) -> Point:
    if (net.degrees[a] > 2) != (net.degrees[b] > 2):
        return net.places[a if net.degrees[a] > 2 else b]
    (ax, ay), (bx, by) = net.places[a], net.places[b]
    return (ax + bx) / 2.0, (ay + by) / 2.0


def _moved_ends(way: Way, gone: int, keep: int, at: Point) -> Way:
    """The way with its ends at a merged place led on to where that is."""
    ends, path = way.ends, way.path_m
    if ends[0] in (gone, keep):
        path = np.concatenate([[at], path])
    if ends[1] in (gone, keep):
        path = np.concatenate([path, [at]])
    first, second = (keep if end == gone else end for end in ends)
    return Way((first, second), path)


def largest_part(net: Net) -> tuple[Net, tuple[Way, ...]]:
    """The connected part with the longest ways, and the ways of the others."""
    part_of = groups(net.places, [way.ends for way in net.ways])
    lengths_m: dict[int, float] = {}
    for way in net.ways:
        part = part_of[way.ends[0]]
        lengths_m[part] = lengths_m.get(part, 0.0) + way.length_m
    largest = max(lengths_m, key=lambda part: lengths_m[part], default=None)
    kept = tuple(way for way in net.ways if part_of[way.ends[0]] == largest)
    apart = tuple(way for way in net.ways if part_of[way.ends[0]] != largest)
    return Net(_still_used(net.places, kept), kept), apart


def groups(places: Iterable[int], pairs: Sequence[tuple[int, int]]) -> dict[int, int]:
    """The least place that each place is connected to by the pairs."""
    group_of = {place: place for place in sorted(places)}
    for a, b in pairs:
        low, high = sorted((group_of[a], group_of[b]))
        for place, group in group_of.items():
            if group == high:
                group_of[place] = low
    return group_of


def _still_used(places: Mapping[int, Point], ways: tuple[Way, ...]) -> dict[int, Point]:
    used = {end for way in ways for end in way.ends}
    return {number: at for number, at in places.items() if number in used}
