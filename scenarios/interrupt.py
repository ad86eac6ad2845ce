"""Ctrl-C and SIGTERM as a request to end well; a second one means now."""

from __future__ import annotations

import contextlib
import signal
from collections.abc import Callable, Iterator

ENDING = (signal.SIGINT, signal.SIGTERM)


class Interrupts:
    """How often the user asked for the end. ``heard`` is called at the first time."""

    def __init__(self, heard: Callable[[], None]) -> None:
        self._heard = heard
        self._count = 0

    def any(self) -> bool:
        """Whether the user asked for the end."""
        return self._count > 0

    def note(self, *_: object) -> None:
        """The user asks again. Raises KeyboardInterrupt from the second time on."""
        self._count += 1
        if self._count > 1:
            raise KeyboardInterrupt
        self._heard()


@contextlib.contextmanager
def interruptible(heard: Callable[[], None] = lambda: None) -> Iterator[Interrupts]:
    """Count the requests while this lasts. Only in the main thread, as Python has it."""
    interrupts = Interrupts(heard)
    before = {number: signal.signal(number, interrupts.note) for number in ENDING}
    try:
        yield interrupts
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
