"""Does something approach? A belief over the things ahead, ping by ping.

Only the transducers that look ahead matter (:class:`modules.reactor.cone.Cones`). An echo
that no known thing explains starts a new one; things that nothing speaks for are dropped.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from modules.reactor.cone import USUAL, Cones, Floats
from modules.reactor.thing import SHAPE, EchoModel, Thing
from modules.reactor.track_kernels import (
    APPROACHING,
    FALSE,
    FIRST_S,
    NOTES,
    PINGS,
    scanned,
)


class ScanError(ValueError):
    """A scan that cannot be used: wrong shape, not after the one before."""


@dataclass(frozen=True, slots=True)
class Scan:
    """One ping of the ring as distributions.

    ``mean_m`` (transducers,) with nan where no echo came back, ``sigma_m`` (transducers,);
    ``speed_m_s`` is the robot's own along the corridor since the last scan, ``lateral_m`` how
    far left of the centre line it is. Raises ScanError for ranges of unequal length.
    """

    time_s: float
    mean_m: Floats
    sigma_m: Floats
    speed_m_s: float = 0.0
    lateral_m: float = 0.0

    def __post_init__(self) -> None:
        if self.mean_m.shape != self.sigma_m.shape or self.mean_m.ndim != 1:
            raise ScanError(
                "a scan needs mean_m and sigma_m of one length, got shapes "
                f"{self.mean_m.shape} and {self.sigma_m.shape}"
            )

    def echoes(self, cones: Cones) -> Floats:
        """Mean and standard deviation for each cone ahead, (cones, 2)."""
        if len(self.mean_m) != cones.transducers:
            raise ScanError(
                f"found {len(self.mean_m)} ranges, expected {cones.transducers}, one a transducer"
            )
        echoes: Floats = np.stack([self.mean_m[cones.numbers], self.sigma_m[cones.numbers]], axis=1)
        return echoes


@dataclass(frozen=True, slots=True)
class Tracker:
    """The things ahead, after the last scan; ``Tracker()`` knows of none.

    ``beliefs`` and ``notes`` are as :mod:`modules.reactor.track_kernels` has them;
    ``approaching`` is the probability of the thing that most likely approaches that it does;
    ``cells`` is the number of table entries that the last update touched.
    """

    cones: Cones = USUAL
    model: EchoModel = field(default_factory=EchoModel)
    time_s: float | None = None
    beliefs: Floats = field(default_factory=lambda: np.empty((0, *SHAPE)))
    notes: Floats = field(default_factory=lambda: np.empty((0, NOTES)))
    lateral_m: float = 0.0
    last_alert_s: float = -np.inf
    approaching: float = 0.0
    cells: int = 0

    attention_at: float = 0.0002
    """Probability of an approaching thing from which faster pings are wanted: an echo that only
    one of two transducers heard that should have is worth another look."""
    alert_at: float = 0.01
    """Probability of an approaching thing from which it is not quiet ahead."""

    @property
    def things(self) -> tuple[Thing, ...]:
        """The things ahead, the oldest first."""
        return tuple(
            Thing(belief, float(note[FALSE]), int(note[PINGS]), float(note[FIRST_S]))
            for belief, note in zip(self.beliefs, self.notes, strict=True)
        )

    @property
    def wants_attention(self) -> bool:
        """Whether faster pings are wanted: something ahead may approach."""
        return self.approaching > self.attention_at

    @property
    def quiet_s(self) -> float:
        """Seconds for which nothing ahead was likely to approach."""
        return np.inf if self.time_s is None else self.time_s - self.last_alert_s


def updated(tracker: Tracker, scan: Scan) -> Tracker:
    """The tracker after a scan.

    Raises ScanError for a scan that is not after the last one or of another ring.
    """
    elapsed_s = 0.0 if tracker.time_s is None else scan.time_s - tracker.time_s
    if elapsed_s < 0 or (elapsed_s == 0 and tracker.time_s is not None):
        raise ScanError(f"scans must follow in time: {scan.time_s} s after {tracker.time_s} s")
    beliefs, notes, cells = scanned(
        tracker.beliefs,
        tracker.notes,
        tracker.cones,
        scan.echoes(tracker.cones),
        scan.time_s,
        elapsed_s,
        scan.speed_m_s * elapsed_s,
        scan.lateral_m,
        tracker.model,
    )
    approaching = float(notes[:, APPROACHING].max()) if len(notes) else 0.0
    return Tracker(
        cones=tracker.cones,
        model=tracker.model,
        time_s=scan.time_s,
        beliefs=beliefs,
        notes=notes,
        lateral_m=scan.lateral_m,
        last_alert_s=scan.time_s if approaching > tracker.alert_at else tracker.last_alert_s,
        approaching=approaching,
        cells=cells,
        attention_at=tracker.attention_at,
        alert_at=tracker.alert_at,
    )
