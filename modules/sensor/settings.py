"""What a scenario may set in [modules.sensor]."""

from __future__ import annotations

import msgspec


class Settings(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Nothing so far."""
