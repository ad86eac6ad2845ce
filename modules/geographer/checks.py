"""Arrays that are likelihoods, odds or weights, and nothing else."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from modules.geographer.errors import EvidenceError

Floats = NDArray[np.float64]


def checked(
    name: str, values: ArrayLike, shape: tuple[int, ...], may_be_scalar: bool = False
) -> Floats:
    """The values as floats of this shape, finite and not negative. Raises EvidenceError."""
    try:
        array = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise EvidenceError(f"{name}: expected numbers of shape {shape}: {error}") from error
    if may_be_scalar and array.ndim == 0:
        array = np.full(shape, array)
    if array.shape != shape:
        raise EvidenceError(f"{name}: found shape {array.shape}, expected {shape}")
    bad = ~(np.isfinite(array) & (array >= 0.0))
    if bad.any():
        place = tuple(int(i) for i in np.argwhere(bad)[0])
        raise EvidenceError(
            f"{name}{list(place)}: found {array[place]}, expected a finite number not below 0"
        )
    return array
