"""What the detectors' readings are worth: Pr(S|X), determined experimentally (paper, section 3).

The model file holds counts from simulated trials, so that anyone can see on how much
evidence each probability rests; probabilities are made from them on loading. The intervals beside
them are for the reader.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bus.features import FEATURES, WedgeError, Wedges
from bus.grid import DIRECTIONS, JUNCTION_TYPES
from modules.classifier.geometry import enterable, layouts, share, shown
from modules.classifier.worth import Detectors

VERSION = 3
EVIDENCE_CLASSES = 4
"""0 = surely absent, 1 = rather absent, 2 = rather present, 3 = surely present."""

LEAST_TOLD = 0.2
"""A detector is worth the search of a plan if it tells this share of what the best one tells. With
the shipped model the others tell less than an eighth of it, or nothing, the rest more than half."""

ASTRAY = 0.01
"""Pr(a visit goes astray): the robot stands elsewhere than it thinks, and all that it reads is of
some other place. Assumption: among the echoes of the SRI K-wing one look in sixty at an open side
was sure that it is closed while doorways were heard from the middle of the corridor only."""

NO_BITS = 1e-9
"""Less is the rounding of nothing."""

SHIPPED = Path(__file__).with_name("sensor_model.json")


def shape_of(wedges: Wedges) -> tuple[int, int, int, int]:
    """The shape of a model's counts: (features, wedges, X, classes)."""
    return len(FEATURES), wedges.count, 2, EVIDENCE_CLASSES


class SensorModelError(ValueError):
    """A sensor model that is missing, malformed, or of another version, ring or wedges."""


@dataclass(frozen=True, eq=False)
class SensorModel:
    """Counts of evidence classes by the truth of X, and how long each detector takes.

    ``counts`` is (features, wedges, X, classes), ``durations_s`` is (features, wedges), ``astray``
    the probability that a visit is not where the robot thinks.
    Raises SensorModelError for other shapes, negative counts or durations that are not positive,
    WedgeError for a number of wedges that cannot be.
    """

    counts: NDArray[np.int64]
    durations_s: NDArray[np.float64]
    ring: Mapping[str, float]
    made_by: str
    astray: float = ASTRAY

    def __post_init__(self) -> None:
        shape = shape_of(self.wedges)
        if self.counts.shape != shape or self.durations_s.shape != shape[:2]:
            raise SensorModelError(
                f"a sensor model needs counts {shape} (feature, wedge, X, class) and durations "
                f"{shape[:2]}, found {self.counts.shape} and {self.durations_s.shape}"
            )
        if (self.counts < 0).any():
            raise SensorModelError(f"counts cannot be negative, found {self.counts.min()}")
        if not (self.durations_s > 0).all():
            raise SensorModelError(f"durations must be positive, found {self.durations_s.min()} s")

    @cached_property
    def wedges(self) -> Wedges:
        """As many as the durations are for."""
        return Wedges(self.durations_s.shape[-1])

    @cached_property
    def probability(self) -> NDArray[np.float64]:
        """Pr(S=class|X) by Laplace smoothing of 0.5: (features, wedges, X, classes).

        Uniform where X never had that value: the geometry then gives that row no weight.
        """
        smooth = self.counts + 0.5
        table: NDArray[np.float64] = smooth / smooth.sum(axis=-1, keepdims=True)
        return table

    @property
    def interval_95(self) -> NDArray[np.float64]:
        """Bounds of Pr(S=class|X) by its posterior: (features, wedges, X, classes, 2), rounded.

        A Dirichlet distribution of 0.5 a class before the trials, whose mean after them is
        :attr:`probability`.
        """
        from scipy.special import betaincinv  # here, since only who writes a model needs it

        a = self.counts + 0.5
        b = a.sum(axis=-1, keepdims=True) - a
        bounds = np.stack([betaincinv(a, b, share) for share in (0.025, 0.975)], axis=-1)
        rounded: NDArray[np.float64] = bounds.round(4)
        return rounded

    @cached_property
    def duration_by_detector_s(self) -> NDArray[np.float64]:
        """Seconds a detector takes, by its code ``feature * wedges + wedge``: (detectors,)."""
        return self.durations_s.ravel()

    @cached_property
    def class_given_layout(self) -> NDArray[np.float64]:
        """P(S=class|layout), X summed out: (headings N E S W, detectors, layouts, classes)."""
        by_truth = self.probability.reshape(-1, 2, EVIDENCE_CLASSES)
        absent, there = (by_truth[None, :, None, x] for x in (0, 1))
        holds = np.array(
            [
                [shown(layout, heading, self.wedges).ravel() for layout in layouts(heading)]
                for heading in DIRECTIONS
            ]
        ).transpose(0, 2, 1)[..., None]
        table: NDArray[np.float64] = (1.0 - holds) * absent + holds * there
        return table

    @cached_property
    def class_given_type(self) -> NDArray[np.float64]:
        """P(S=class|J), layouts summed out: (headings N E S W, detectors, types, classes).

        Rows of types that a heading cannot enter are zero.
        """
        detectors = self.wedges.detectors
        table = np.zeros((len(DIRECTIONS), detectors, JUNCTION_TYPES, EVIDENCE_CLASSES))
        for number, heading in enumerate(DIRECTIONS):
            for k, layout in enumerate(layouts(heading)):
                seen = self.class_given_layout[number, :, k]
                table[number, :, layout.type] += share(layout, heading) * seen
        return table

    @cached_property
    def class_given_state(self) -> NDArray[np.float64]:
        """P(S=class|layout), last P(S=class|astray): (headings, detectors, layouts + 1, classes).

        A detector whose visit has gone astray looks at some other place: it reads as at any type
        that can be entered.
        """
        entered = np.array([enterable(heading).sum() for heading in DIRECTIONS])
        astray = self.class_given_type.sum(axis=2) / entered[:, None, None]
        return np.concatenate([self.class_given_layout, astray[:, :, None, :]], axis=2)

    @cached_property
    def informative(self) -> tuple[tuple[NDArray[np.int64], Detectors], ...]:
        """For each heading N E S W the detectors that can tell types apart: codes and tables.

        Most of the others find the same whatever the type, since their feature is present at all or
        none of the types that can be entered; those of door jambs tell too little to be searched.
        Tables are over the types that can be entered, in order.
        """
        return tuple(map(self._informative, range(len(DIRECTIONS))))

    def _informative(self, heading: int) -> tuple[NDArray[np.int64], Detectors]:
        by_class = self.class_given_type[heading].transpose(0, 2, 1)
        by_class = by_class[:, :, enterable(DIRECTIONS[heading])]
        bits = _bits(by_class)
        codes = np.flatnonzero(bits > LEAST_TOLD * max(bits.max(), NO_BITS))
        told = np.ascontiguousarray(by_class[codes])
        return codes, Detectors(told, self.duration_by_detector_s[codes])

    def as_json(self) -> str:
        """The model as the text of its file."""
        whole = {
            "version": VERSION,
            "made_by": self.made_by,
            "ring": dict(self.ring),
            "features": list(FEATURES),
            "wedges": self.wedges.count,
            "duration_s": _by_detector(self.durations_s),
            "counts": _by_detector(self.counts),
            "interval_95": _by_detector(self.interval_95),
        }
        lines = [f'  "{key}": {_text(value)}' for key, value in whole.items()]
        return "{\n" + ",\n".join(lines) + "\n}\n"


def load_sensor_model(
    path: Path = SHIPPED,
    expected_ring: Mapping[str, float] | None = None,
    expected_wedges: int | None = None,
) -> SensorModel:
    """Read a model file.

    With ``expected_ring`` or ``expected_wedges``, refuse one made with other figures than these.
    Raises SensorModelError, which names the file and what was found and expected.
    """
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError as error:
        raise SensorModelError(
            f"{path}: no sensor model there; make one with `waywiser calibrate detectors`"
        ) from error
    except ValueError as error:
        raise SensorModelError(f"{path}: not JSON: {error}") from error
    try:
        model = _checked(content)
        _check_ring(model.ring, expected_ring)
        _check_wedges(model.wedges.count, expected_wedges)
        return model
    except SensorModelError as error:
        raise SensorModelError(f"{path}: {error}") from error


def _checked(content: Any) -> SensorModel:
    if not isinstance(content, dict) or content.get("version") != VERSION:
        found = content.get("version") if isinstance(content, dict) else type(content).__name__
        raise SensorModelError(f"expected version {VERSION}, found {found!r}")
    if content.get("features") != list(FEATURES):
        raise SensorModelError(
            f"expected features {list(FEATURES)}, found {content.get('features')!r}"
        )
    try:
        counts = [content["counts"][feature] for feature in FEATURES]
        durations = [content["duration_s"][feature] for feature in FEATURES]
        model = SensorModel(
            counts=np.array(counts, dtype=np.int64),
            durations_s=np.array(durations, dtype=np.float64),
            ring={str(key): float(value) for key, value in content["ring"].items()},
            made_by=str(content["made_by"]),
        )
    except (SensorModelError, WedgeError) as error:
        raise SensorModelError(str(error)) from None
    except KeyError as error:
        raise SensorModelError(f"the key {error} is missing") from error
    except (AttributeError, TypeError, ValueError) as error:
        raise SensorModelError(f"malformed numbers: {error}") from error
    _check_wedges(model.wedges.count, content.get("wedges"))
    return model


def _check_wedges(found: int, expected: object) -> None:
    if expected is not None and found != expected:
        raise SensorModelError(
            f"made with {found} wedges, expected {expected}; `waywiser calibrate detectors "
            f"--wedges {expected}` makes such a model, and modules.classifier.sensor_model names it"
        )


def _check_ring(found: Mapping[str, float], expected: Mapping[str, float] | None) -> None:
    if expected is None:
        return
    for key in sorted(expected):
        if found.get(key) != expected.get(key):
            raise SensorModelError(
                f"made with another ring: {key} is {found.get(key)}, expected {expected[key]}"
            )


def _bits(by_class: NDArray[np.float64]) -> NDArray[np.float64]:
    """What a reading tells of the type, all as probable before: (detectors, classes, types) given.

    Mutual information in bits, (detectors,).
    """
    each = by_class.mean(axis=2, keepdims=True)
    told: NDArray[np.float64] = (by_class * np.log2(by_class / each)).sum(axis=1).mean(axis=1)
    return told


def _by_detector(values: NDArray[Any]) -> dict[str, Any]:
    return {name: values[f].tolist() for f, name in enumerate(FEATURES)}


def _text(value: Any) -> str:
    """JSON with one line a wedge or list of numbers: a new calibration is easy to compare."""
    if not (isinstance(value, dict) and all(isinstance(v, list) for v in value.values())):
        return json.dumps(value)
    features = [f"    {json.dumps(name)}: {_wedges(rows)}" for name, rows in value.items()]
    return "{\n" + ",\n".join(features) + "\n  }"


def _wedges(rows: list[Any]) -> str:
    if not all(isinstance(row, list) for row in rows):
        return json.dumps(rows)
    return "[\n" + ",\n".join(f"      {json.dumps(row)}" for row in rows) + "\n    ]"
