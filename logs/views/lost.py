"""A robot that does not know where it is, in words: where it may be, and what it does about it."""

from __future__ import annotations

import math

import numpy as np

from bus import messages as m
from bus.grid import type_name


def may_be_at(said: m.Registrations) -> str:
    """Every intersection that may be ahead, the likeliest first."""
    order = np.argsort(-said.weights, kind="stable").tolist()
    each = [f"{said.places[k]} ({said.weights[k]:.3f})" for k in order]
    return f"visit {said.visit} may be at intersection {', '.join(each)}"


def at_errand(said: m.AtErrand) -> str:
    """Whether the errand's end was found."""
    who, then = ("somebody", "this is") if said.here else ("nobody", "this is not")
    return f"{who} expects the robot here: {then} intersection {said.waypoint}"


def looks_or_acts(said: m.RegistrationDecision) -> str:
    """What it does for each junction type that it reckons with, and what else that would cost."""
    known = np.flatnonzero(np.isfinite(said.now_s)).tolist()
    each = [f"{type_name(k)}: {choice(said, k)}" for k in known]
    return f"path decision {said.decision}, visit {said.visit}: {'; '.join(each) or 'no map fits'}"


def choice(said: m.RegistrationDecision, junction_type: int) -> str:
    """The choice for one junction type, with both costs."""
    now_s, look_s = float(said.now_s[junction_type]), float(said.look_s[junction_type])
    look = f"{look_s:,.0f} s" if math.isfinite(look_s) else "nowhere to look"
    if said.detour[junction_type]:
        where = f"as if at {said.acts_at[junction_type]} looks at {said.looks_at[junction_type]}"
        return f"{where} first, {look} against {now_s:,.0f} s at once"
    return f"goes as if at {said.acts_at[junction_type]}, {now_s:,.0f} s; after a look: {look}"
