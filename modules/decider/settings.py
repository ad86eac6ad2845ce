"""What a scenario may set in [modules.decider]."""

from __future__ import annotations

from typing import Annotated, Literal

import msgspec


class Settings(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """How much to consider.

    ``hypotheses``: maps considered for each junction type; a number is used even if it cannot
    be done in time. ``sensing_s``: what classifying a new junction takes. A robot that does not
    ``explores`` sees no value in knowing the building later.
    """

    hypotheses: Annotated[int, msgspec.Meta(ge=1, le=64)] | Literal["as many as fit"] = (
        "as many as fit"
    )
    sensing_s: Annotated[float, msgspec.Meta(ge=0)] = 90.0
    explores: bool = True
