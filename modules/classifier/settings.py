"""What a scenario may set in [modules.classifier]."""

from __future__ import annotations

from typing import Annotated

import msgspec


class Settings(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """How much information a second of sensing must bring for it to go on, in nats."""

    worth_nats_per_s: Annotated[float, msgspec.Meta(ge=0)] = 0.0002
