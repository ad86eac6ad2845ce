"""What can be wrong with a question about the map."""

from __future__ import annotations


class GridTooWideError(ValueError):
    """The grid's shorter side has too many lines for an exact belief over all maps."""


class EvidenceError(ValueError):
    """An array of likelihoods, odds or maps has the wrong shape or an impossible entry."""


class ContradictoryEvidenceError(ValueError):
    """No connected map has positive probability under the evidence given."""
