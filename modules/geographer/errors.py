"""What can be wrong with a question about the map."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

Place: TypeAlias = tuple[int, int]


class ProblemTooLargeError(ValueError):
    """An exact belief over all maps would need more memory than is allowed."""


class GridTooWideError(ProblemTooLargeError):
    """The grid's shorter side has too many lines for an exact belief over all maps."""


class EvidenceError(ValueError):
    """An array of likelihoods, odds or maps has the wrong shape or an impossible entry."""


class ContradictoryEvidenceError(ValueError):
    """No connected map has positive probability under the evidence given.

    `junctions` (x, y) and `corridors`, as pairs of ends, have the evidence that no map fits
    together with the prior, where a smallest part of it was looked for.
    """

    def __init__(
        self,
        message: str,
        junctions: Sequence[Place] = (),
        corridors: Sequence[tuple[Place, Place]] = (),
    ) -> None:
        super().__init__(message)
        self.junctions, self.corridors = list(junctions), list(corridors)
