"""From the space that the robot passes to the net of its skeleton."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from simworld.survey.net import Net, Point, Way
from simworld.survey.space import Space

Pixel: TypeAlias = tuple[int, int]
Neighbours: TypeAlias = dict[Pixel, list[Pixel]]

_ASIDE = ((0, 1), (1, 0), (0, -1), (-1, 0))
_DIAGONAL = ((1, 1), (1, -1), (-1, -1), (-1, 1))


def skeleton_net(space: Space) -> Net:
    """The net of the passable space's skeleton, in metres along the rows and columns."""
    from skimage.morphology import skeletonize  # takes a while to import

    skeleton: NDArray[np.bool_] = skeletonize(space.passable)  # type: ignore[no-untyped-call]
    return net_of_pixels(skeleton, space.resolution_m)


def net_of_pixels(skeleton: NDArray[np.bool_], resolution_m: float) -> Net:
    """Places where a thin line ends or parts, ways between them; a ring has one place."""
    neighbours = _neighbours(skeleton)
    place_of = _place_of(neighbours, skeleton.shape)
    middle: dict[int, list[Pixel]] = {}
    for pixel, number in place_of.items():
        middle.setdefault(number, []).append(pixel)
    places = {
        number: _metres(np.mean(pixels, axis=0), resolution_m) for number, pixels in middle.items()
    }
    ways = [
        Way(
            (place_of[line[0]], place_of[line[-1]]),
            np.array(
                [
                    places[place_of[line[0]]],
                    *(_metres(np.array(pixel), resolution_m) for pixel in line[1:-1]),
                    places[place_of[line[-1]]],
                ]
            ),
        )
        for line in _lines(neighbours, place_of)
    ]
    return Net(places, tuple(ways))


def _metres(pixel: NDArray[np.float64], resolution_m: float) -> Point:
    """The middle of a pixel (row, column) as (u, v)."""
    return float(pixel[1] + 0.5) * resolution_m, float(pixel[0] + 0.5) * resolution_m


def _neighbours(skeleton: NDArray[np.bool_]) -> Neighbours:
    """Of each pixel; a diagonal one only where no third pixel joins the two."""
    found: list[Pixel] = [(int(row), int(column)) for row, column in np.argwhere(skeleton)]
    pixels = dict.fromkeys(found)
    neighbours: Neighbours = {}
    for row, column in pixels:
        aside = [(row + r, column + c) for r, c in _ASIDE if (row + r, column + c) in pixels]
        across = [
            (row + r, column + c)
            for r, c in _DIAGONAL
            if (row + r, column + c) in pixels
            and (row + r, column) not in pixels
            and (row, column + c) not in pixels
        ]
        neighbours[row, column] = aside + across
    return neighbours


def _place_of(neighbours: Neighbours, shape: tuple[int, ...]) -> dict[Pixel, int]:
    """The number of the place of each pixel that belongs to one."""
    parting = np.zeros(shape, np.bool_)
    for pixel, around in neighbours.items():
        parting[pixel] = len(around) > 2
    labels, last = ndimage.label(parting, np.ones((3, 3)))
    place_of: dict[Pixel, int] = {}
    for pixel, around in neighbours.items():
        if parting[pixel]:
            place_of[pixel] = int(labels[pixel])
        elif len(around) < 2:
            last += 1
            place_of[pixel] = last
    for pixel in _ringed(neighbours, place_of):
        last += 1
        place_of[pixel] = last
    return place_of


def _ringed(neighbours: Neighbours, place_of: dict[Pixel, int]) -> list[Pixel]:
    """One pixel of each ring that has no place."""
    seen = dict.fromkeys(pixel for line in _lines(neighbours, place_of) for pixel in line)
    seen.update(dict.fromkeys(place_of))
    first = []
    for pixel in neighbours:
        if pixel in seen:
            continue
        first.append(pixel)
        following = [pixel]
        while following:
            this = following.pop()
            if this not in seen:
                seen[this] = None
                following += neighbours[this]
    return first


def _lines(neighbours: Neighbours, place_of: dict[Pixel, int]) -> Iterator[list[Pixel]]:
    """Runs of pixels from place to place, each once."""
    done: dict[tuple[Pixel, Pixel], None] = {}
    for start in place_of:
        for step in neighbours[start]:
            if (start, step) in done or place_of.get(step) == place_of[start]:
                continue
            line = [start, step]
            while line[-1] not in place_of:
                line.append(next(n for n in neighbours[line[-1]] if n != line[-2]))
            done[line[-1], line[-2]] = None
            yield line
