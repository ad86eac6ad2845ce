"""What a scenario may set in [modules.decider]."""

from __future__ import annotations

from typing import Annotated, Literal

import msgspec

from modules.decider.methods import Choice
from modules.decider.whereabouts import Rule


class Settings(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """How much to consider.

    ``hypotheses``: maps considered for each junction type; a number is used even if it cannot
    be done in time. ``sensing_s``: what classifying a new junction takes. A robot that does not
    ``explores`` sees no value in knowing the building later. ``method``: E[P_K] against E[P_U]
    (paper, section 3), or a method of section 4 from the first errand on, or the one that is the
    best by estimate for each goal. ``model``: what expected value is: the paper's P_K and P_U, or
    plans of least expected cost over all errands (outlook.py). ``unsure``: what a robot does that
    does not know where it is: decide whether to look first, or one of the two always.
    """

    hypotheses: Annotated[int, msgspec.Meta(ge=1, le=64)] | Literal["as many as fit"] = (
        "as many as fit"
    )
    sensing_s: Annotated[float, msgspec.Meta(ge=0)] = 90.0
    explores: bool = True
    method: Choice | Literal["expected value"] = "expected value"
    model: Literal["paper", "least expected cost"] = "least expected cost"
    unsure: Rule = "least expected cost"
