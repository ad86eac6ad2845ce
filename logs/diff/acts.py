"""What two answers to the same question choose, where they choose differently."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bus.grid import LETTER, type_name
from bus.messages import Message, PathDecision, ReactionDecision, SensingDecision

STAY = "stay"
STOP = -1


def flips(base: Message, new: Message) -> tuple[str, ...]:
    """Where the choices differ, ``type NE: E -> N`` say; empty where they are the same.

    A contingent decision chooses for every outcome: for every junction type that may wait at
    the far end, for every evidence class that the running detector may find.
    """
    match base, new:
        case ReactionDecision(), ReactionDecision():
            return () if base.act == new.act else (f"{base.act} -> {new.act}",)
        case PathDecision(), PathDecision():
            return tuple(
                f"type {type_name(k)}: {_way(base.direction[k])} -> {_way(new.direction[k])}"
                for k in _unlike(base.direction, new.direction)
            )
        case SensingDecision(), SensingDecision():
            return _detectors(base, new)
    return ()


def _unlike(one: NDArray[np.generic], two: NDArray[np.generic]) -> list[int]:
    return np.flatnonzero(one != two).tolist()


def _way(direction: int) -> str:
    return LETTER.get(int(direction), STAY)


def _detectors(base: SensingDecision, new: SensingDecision) -> tuple[str, ...]:
    before, after = _next(base), _next(new)
    if len(before) != len(after):
        return (f"for {len(before)} outcomes -> for {len(after)}",)
    pairs = enumerate(zip(before, after, strict=True))
    if len(before) == 1:
        return tuple(f"{one} -> {two}" for _, (one, two) in pairs if one != two)
    return tuple(f"outcome {k}: {one} -> {two}" for k, (one, two) in pairs if one != two)


def _next(decision: SensingDecision) -> list[str]:
    each = zip(decision.next_detector.tolist(), decision.concluded.tolist(), strict=True)
    return [f"conclude {type_name(c)}" if d == STOP else f"detector {d}" for d, c in each]
