"""The survey of a floor plan, step by step."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from simworld.floor_plan import FloorPlan
from simworld.survey.doors import Door
from simworld.survey.errors import SurveyError
from simworld.survey.lines import grid_lines
from simworld.survey.net import Net, Way, joined, largest_part, merged, pruned
from simworld.survey.placing import corridor_widths, corridors_of, junctions_of, used_lines
from simworld.survey.result import Survey
from simworld.survey.skeleton import skeleton_net
from simworld.survey.space import Space, space_of
from simworld.survey.straighten import askew_rad, cornered, runs_east, upright_turn_rad

DOOR_STUB_M = 10.0
"""Reach of a way that leads nowhere, from the middle of the corridor that it leaves, up to which
it counts as a door, niche or room: nothing else tells such a way from a corridor."""

ROBOT_RADIUS_M = 0.3
"""The robot passes what is wider than twice this."""

LINE_GAP_M = 3.0
"""Parallel corridors whose middles are nearer than this lie on one grid line."""

STRAIGHT_M = 1.0
"""A corridor's middle line strays by no more than this from a straight line."""

ASKEW_RAD = math.radians(25.0)
"""A way that is further than this from both axes is no corridor of the grid."""

CUT_CORNER_M = 7.0
"""In the corner of a wide space the middle line cuts across by up to about this."""


def survey(plan: FloorPlan, door_stub_m: float = DOOR_STUB_M, doors: Sequence[Door] = ()) -> Survey:
    """Find the corridors and junctions of a floor plan, and the grid that they lie on.

    ``doors`` are closed before, but for those between corridors. Raises SurveyError where the
    plan shows no corridors, and for a door stub that is no positive length.
    """
    if not (math.isfinite(door_stub_m) and door_stub_m > 0.0):
        raise SurveyError(f"door stub: found {door_stub_m} m, expected a positive length")
    space = space_of(plan, ROBOT_RADIUS_M, doors, door_stub_m)
    if not space.passable.any():
        raise SurveyError(
            f"found no free space wider than {2 * ROBOT_RADIUS_M:g} m, expected corridors"
        )
    net = _simplified(skeleton_net(space), space, door_stub_m)
    turn_rad = math.remainder(upright_turn_rad(net) - plan.turn_rad, math.pi / 2.0)
    upright = plan.moved(turn_rad)
    net, widths_m, askew = _corridors_only(_upright(net, upright), space, upright)
    lines = grid_lines(net, LINE_GAP_M)
    corridors, dropped = corridor_widths(net, widths_m, lines)
    if not corridors:
        raise SurveyError(
            "found free space without corridors, expected passages longer than wide. An open floor "
            "has none; open doors may hide them (a doors file closes those), and a way that leads "
            f"nowhere must reach {door_stub_m:g} m (the door stub)"
        )
    columns, rows = used_lines(corridors)
    return Survey(
        plan=upright,
        turn_rad=turn_rad,
        columns_m=tuple(lines.columns_m[x] for x in columns),
        rows_m=tuple(lines.rows_m[y] for y in rows),
        junctions=junctions_of(net, lines, corridors),
        corridors=corridors_of(lines, corridors),
        left_out=(*askew, *dropped),
        paths_m=tuple(way.path_m for way in net.ways),
    )


def _simplified(net: Net, space: Space, door_stub_m: float) -> Net:
    """Places at junctions and corners only, in the image's frame."""

    def overlap(net: Net, way: Way) -> bool:
        """The widest circles around both ends touch: they are one junction."""
        return way.length_m < sum(space.clearance_m(*net.places[end]) for end in way.ends)

    net = pruned(merged(pruned(net, door_stub_m), overlap), door_stub_m)
    net = cornered(net, STRAIGHT_M)
    turn_rad = upright_turn_rad(net)

    def cuts_corner(way: Way) -> bool:
        return way.length_m < CUT_CORNER_M and askew_rad(way, turn_rad) > ASKEW_RAD

    return merged(net, lambda net, way: overlap(net, way) or cuts_corner(way))


def _upright(net: Net, upright: FloorPlan) -> Net:
    """The net in the upright frame, without places at which one corridor just goes on."""
    places = {}
    for number, at in net.places.items():
        x, y = upright.to_world(*at)
        places[number] = float(x), float(y)
    ways = tuple(
        replace(way, path_m=np.column_stack(upright.to_world(*way.path_m.T))) for way in net.ways
    )
    return joined(Net(places, ways), lambda a, b: runs_east(a) == runs_east(b))


def _corridors_only(
    net: Net, space: Space, upright: FloorPlan
) -> tuple[Net, dict[Way, float], list[str]]:
    """The upright net without what is no corridor; widths; what was left out.

    All LDPs are connected (paper, section 3), so of several parts the largest is kept.
    """
    widths_m = {way: _width_m(way, space, upright) for way in net.ways}
    why = {way: _no_corridor(way, widths_m[way]) for way in net.ways}
    corridors = tuple(way for way in net.ways if why[way] is None)
    kept, apart = largest_part(Net(net.places, corridors))
    why |= dict.fromkeys(apart, "apart from the rest")
    left_out = []
    for way, said in why.items():
        if said is not None:
            (ax, ay), (bx, by) = way.path_m[0], way.path_m[-1]
            left_out.append(f"{said}: {ax:.1f}, {ay:.1f} to {bx:.1f}, {by:.1f}")
    return kept, widths_m, left_out


def _no_corridor(way: Way, width_m: float) -> str | None:
    """Why an upright way is no corridor; None if it is one."""
    if way.ends[0] == way.ends[1]:
        return f"a loop of {way.length_m:.1f} m"
    if askew_rad(way) > ASKEW_RAD:
        return f"{math.degrees(askew_rad(way)):.0f} degrees askew"
    if way.length_m < width_m:
        return f"{width_m:.1f} m wide and only {way.length_m:.1f} m long"
    return None


def _width_m(way: Way, space: Space, upright: FloorPlan) -> float:
    """Twice the median clearance along the middle half of an upright way."""
    quarter = len(way.path_m) // 4
    middle = way.path_m[quarter : len(way.path_m) - quarter]
    points = np.column_stack(upright.to_image(*middle.T))
    return 2.0 * float(np.median([space.clearance_m(u, v) for u, v in points]))
