"""What a scenario may set in [modules.geographer]."""

from __future__ import annotations

from typing import Annotated

import msgspec


class Settings(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The prior, and how many maps stand for the belief.

    ``corridor_odds``: prior odds that a corridor exists; ``maps_per_type``: how many maps
    at most stand for each junction type that the LDP ahead may have.
    """

    corridor_odds: Annotated[float, msgspec.Meta(gt=0)] = 1.0
    maps_per_type: Annotated[int, msgspec.Meta(ge=1, le=64)] = 32
