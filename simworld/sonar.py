"""The sonar ring: what each transducer hears of walls, corners and people.

The paper names neither the sonars nor their figures. Those here are typical of the ring of
Polaroid 6500 modules that robots of 1990 carried; :class:`SonarRing` says of each where it is from.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from simworld.building import Building
from simworld.floor_plan import FloorPlan
from simworld.raycast import hear_segments
from simworld.raycast_cells import hear_cells

People: TypeAlias = Sequence[tuple[float, float, float]] | NDArray[np.float64]
"""Round people who always echo: x, y and radius in metres, each."""

Surroundings: TypeAlias = Building | FloorPlan
"""What reflects sound: walls and corners, or the occupied cells of a real building's plan."""


class SonarError(ValueError):
    """A sonar ring with figures that no ring can have."""


@dataclass(frozen=True)
class SonarRing:
    """A ring of equal transducers, the first straight ahead, the rest counter-clockwise.

    - ``transducers``: 24, as on the Denning and Nomad robots of the time (assumption: the paper
      does not say how many Huey had).
    - ``half_angle_rad``: 15 deg, a hard-edged cone; the Polaroid transducer's main lobe has its
      first null near 15 deg at 50 kHz (Leonard and Durrant-Whyte, Directed Sonar Sensing for
      Mobile Robot Navigation, 1992).
    - ``nearest_m`` .. ``farthest_m``: 0.15 m (6 inches) .. 10.7 m (35 feet), the range that the
      Polaroid 6500 data sheet states.
    - ``noise_share``, ``noise_m``: standard deviation 1 % of the range (the data sheet's
      accuracy) plus 10 mm (assumption: threshold detection late by up to two wavelengths).
    - ``specular_limit_rad``: a smooth wall, a mirror at a wavelength of 7 mm, is heard up to
      22.5 deg from its normal and not beyond (assumption, for painted plaster).
    - ``dropout``: share of echoes that are not heard, 2 % (assumption).
    - ``cross_talk``: share of readings that are another's echo: too short, uniform between the
      nearest range and the true one, 1 % (assumption).

    Raises SonarError for figures out of their domain.
    """

    transducers: int = 24
    half_angle_rad: float = math.radians(15.0)
    nearest_m: float = 0.15
    farthest_m: float = 10.7
    noise_share: float = 0.01
    noise_m: float = 0.01
    specular_limit_rad: float = math.radians(22.5)
    dropout: float = 0.02
    cross_talk: float = 0.01

    def __post_init__(self) -> None:
        right_angle = math.pi / 2
        sound = {
            "transducers, at least 1": self.transducers >= 1,
            "half_angle_rad in (0, pi/2)": 0.0 < self.half_angle_rad < right_angle,
            "specular_limit_rad in [0, pi/2)": 0.0 <= self.specular_limit_rad < right_angle,
            "nearest_m less than farthest_m": 0.0 <= self.nearest_m < self.farthest_m,
            "noise not negative": self.noise_share >= 0.0 and self.noise_m >= 0.0,
            "dropout in [0, 1]": 0.0 <= self.dropout <= 1.0,
            "cross_talk in [0, 1]": 0.0 <= self.cross_talk <= 1.0,
        }
        for expected, holds in sound.items():
            if not holds:
                raise SonarError(f"found {self}, expected {expected}")

    def axes_rad(self, heading_rad: float) -> NDArray[np.float64]:
        """Where each transducer points, (transducers,), for a robot with this heading."""
        step = 2.0 * math.pi / self.transducers
        return heading_rad + step * np.arange(self.transducers, dtype=np.float64)

    def sigma_m(self, ranges_m: NDArray[np.float64]) -> NDArray[np.float64]:
        """Standard deviation of the noise at each range, same shape."""
        return self.noise_share * ranges_m + self.noise_m


def echoes(
    ring: SonarRing,
    surroundings: Surroundings,
    x_m: float,
    y_m: float,
    heading_rad: float,
    rng: np.random.Generator,
    people: People = (),
    crossed_share: NDArray[np.float64] | None = None,
) -> NDArray[np.float64]:
    """One ping of every transducer from a pose: (transducers,) in metres, nan where no echo.

    Noise, dropouts and cross-talk are drawn from ``rng``, the same number of draws whatever the
    surroundings. What is nearer than the ring's nearest range blinds that transducer.
    ``crossed_share`` (transducers,), if given, is in place of the ring's ``cross_talk``.
    """
    heard = true_ranges_m(ring, surroundings, x_m, y_m, heading_rad, people)
    noise = rng.standard_normal(ring.transducers)
    lost, crossed, where = rng.random((3, ring.transducers))
    blind = heard < ring.nearest_m
    limit = np.minimum(heard, ring.farthest_m)
    reading = heard + ring.sigma_m(limit) * noise
    reading[(lost < ring.dropout) | (reading > ring.farthest_m)] = np.nan
    wrong = crossed < (ring.cross_talk if crossed_share is None else crossed_share)
    reading[wrong] = (ring.nearest_m + where * (limit - ring.nearest_m))[wrong]
    np.maximum(reading, ring.nearest_m, out=reading)
    reading[blind] = np.nan
    return reading


def true_ranges_m(
    ring: SonarRing,
    surroundings: Surroundings,
    x_m: float,
    y_m: float,
    heading_rad: float,
    people: People = (),
) -> NDArray[np.float64]:
    """Ranges without noise of the nearest echo in each cone, (transducers,); inf for none."""
    round_people = np.asarray(people, dtype=np.float64).reshape(-1, 3)
    if isinstance(surroundings, FloorPlan):
        return _among_cells(ring, surroundings, x_m, y_m, heading_rad, round_people)
    ranges: NDArray[np.float64] = hear_segments(
        surroundings.walls,
        surroundings.corners,
        round_people,
        float(x_m),
        float(y_m),
        ring.axes_rad(heading_rad),
        ring.half_angle_rad,
        ring.specular_limit_rad,
        ring.farthest_m,
    )
    return ranges


def _among_cells(
    ring: SonarRing,
    plan: FloorPlan,
    x_m: float,
    y_m: float,
    heading_rad: float,
    people: NDArray[np.float64],
) -> NDArray[np.float64]:
    """As :func:`true_ranges_m`, in the image's frame."""
    u, v = plan.to_image(x_m, y_m)
    people_u, people_v = plan.to_image(people[:, 0], people[:, 1])
    ranges: NDArray[np.float64] = hear_cells(
        plan.cells.occupied,
        plan.cells.normals_rad,
        plan.cells.resolution_m,
        np.column_stack([people_u, people_v, people[:, 2]]),
        float(u),
        float(v),
        ring.axes_rad(heading_rad - plan.turn_rad),
        ring.half_angle_rad,
        ring.specular_limit_rad,
        ring.farthest_m,
    )
    return ranges
