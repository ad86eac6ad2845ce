"""What a scenario may set in [modules.classifier]."""

from __future__ import annotations

from typing import Annotated, Literal

import msgspec


class Settings(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """What a wrong conclusion costs, in seconds, and how many tests a plan may hold at most.

    What the decider says that it costs is taken where ``heeds_stakes``, times ``doubt``: how many
    times as often the robot is thought to err among surfaces unlike those of its calibration.
    Where the decider does not say, and never more, it is ``wrong_type_s``, the assumption in
    :data:`modules.classifier.choose.WRONG_TYPE_S`. Plans
    are as long as the time until the deadline allows, up to ``look_ahead``. ``sensor_model`` is a
    file that ``waywiser calibrate detectors`` wrote; the shipped one if none is given.
    """

    heeds_stakes: bool = True
    doubt: Annotated[float, msgspec.Meta(ge=1, le=1e6)] = 10.0
    wrong_type_s: Annotated[float, msgspec.Meta(ge=0, le=1e9)] = 100_000.0
    look_ahead: Literal[1, 2, 3] = 3
    sensor_model: str | None = None
