"""What can be wrong with the paper's network."""

from __future__ import annotations


class HypothesesError(ValueError):
    """A set of hypotheses that is empty, of the wrong shape, or has a map twice or in pieces."""


class FeatureError(ValueError):
    """A feature whose parents are not neighbours, or whose tables do not fit."""


class ContradictedHypothesesError(ValueError):
    """The evidence leaves no state of H, not even NOTA; `junctions` (x, y) rule types out."""

    def __init__(self, junctions: list[tuple[int, int]]) -> None:
        self.junctions = junctions
        named = ", ".join(f"[{x},{y}]" for x, y in junctions)
        super().__init__(
            "no state of H has positive probability, not even NOTA: types are ruled out at "
            f"junctions [x,y] {named or 'none'}"
        )


class NetworksMissingError(ImportError):
    """A library for Bayes nets is not installed; the text says what to install."""

    def __init__(self, library: str) -> None:
        super().__init__(
            f"{library} is not installed: the paper's network is declared with pgmpy and solved by "
            "pyAgrum; install both with `pip install 'waywiser[networks]'`"
        )
