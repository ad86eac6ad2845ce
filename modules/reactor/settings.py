"""What a scenario may set in [modules.reactor]."""

from __future__ import annotations

from typing import Annotated

import msgspec


class Settings(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """``attention_s``: how often the ring fires once something ahead looks new."""

    attention_s: Annotated[float, msgspec.Meta(ge=0.01, le=3600)] = 0.25
