"""Deliberation scheduling: one processor's time given to decisions by marginal value.

After Boddy and Dean (IJCAI 1989): a performance profile says what an answer is worth by the seconds
spent on it; time is allotted backward from the last deadline, each slice to the decision that gains
most from it among those whose deadline has not passed by then. A price a second, what else the
processor could do, is what a slice must gain at least.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise


@dataclass(frozen=True)
class Profile:
    """What an answer costs in expectation by the seconds spent on it, between given points.

    ``seconds`` rise from 0, ``excess_s`` never rise: the points of a curve. Made by
    :func:`convex`, gains a second never rise either, as the allocation requires.
    """

    seconds: tuple[float, ...]
    excess_s: tuple[float, ...]

    def gain_a_second(self, spent_s: float) -> float:
        """What the next second saves, 0 beyond the last point."""
        after = bisect_right(self.seconds, spent_s)
        if after == len(self.seconds):
            return 0.0
        saved = self.excess_s[after - 1] - self.excess_s[after]
        return saved / (self.seconds[after] - self.seconds[after - 1])

    def until_s(self, spent_s: float) -> float:
        """Up to where the gain a second stays the same; inf beyond the last point."""
        after = bisect_right(self.seconds, spent_s)
        return self.seconds[after] if after < len(self.seconds) else float("inf")


def convex(seconds: Sequence[float], excess_s: Sequence[float]) -> Profile:
    """The lower convex hull of a measured curve.

    Between two points on it the answer of the first is had; the hull says what time is worth on
    the way to the next. Raises ValueError where there are no points or seconds do not rise from 0.
    """
    if not seconds or seconds[0] != 0.0 or any(b <= a for a, b in pairwise(seconds)):
        raise ValueError(f"seconds: found {list(seconds)}, expected numbers that rise from 0")
    hull: list[tuple[float, float]] = []
    for point in zip(seconds, excess_s, strict=True):
        if hull and point[1] >= hull[-1][1]:
            continue
        while len(hull) > 1 and _slope(hull[-2], hull[-1]) >= _slope(hull[-2], point):
            hull.pop()
        hull.append(point)
    return Profile(tuple(at for at, _ in hull), tuple(value for _, value in hull))


def _slope(a: tuple[float, float], b: tuple[float, float]) -> float:
    return (b[1] - a[1]) / (b[0] - a[0])


@dataclass(frozen=True)
class Wanted:
    """A decision that wants time: its profile, and how long it is until its deadline."""

    profile: Profile
    left_s: float


def allotted(wanted: Mapping[str, Wanted], price: float = 0.0) -> dict[str, float]:
    """Seconds for each decision; together no more than there are before any deadline.

    Where gains are equal the first of the mapping comes first. Raises ValueError for a price
    below 0.
    """
    if price < 0.0:
        raise ValueError(f"price is {price}, expected at least 0")
    given = dict.fromkeys(wanted, 0.0)
    ends = sorted({0.0, *(max(0.0, one.left_s) for one in wanted.values())})
    for begins, until in zip(reversed(ends[:-1]), reversed(ends[1:]), strict=True):
        free = until - begins
        open_then = [name for name, one in wanted.items() if one.left_s >= until]
        while free > 0.0:
            gains = {n: wanted[n].profile.gain_a_second(given[n]) for n in open_then}
            best = max(open_then, key=lambda n: gains[n])
            if gains[best] <= price:
                break
            slice_s = min(free, wanted[best].profile.until_s(given[best]) - given[best])
            given[best] += slice_s
            free -= slice_s
    return given


def useful_s(profile: Profile, given_s: float) -> float:
    """The part of an allotment that buys anything: up to the last point that was reached."""
    reached = bisect_left(profile.seconds, given_s + 1e-9) - 1
    return profile.seconds[max(0, reached)]
