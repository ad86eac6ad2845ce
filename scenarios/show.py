"""A run's progress on the terminal: one live line, or a line now and then where it is no tty."""

from __future__ import annotations

import time
from types import TracebackType
from typing import Self

from rich.console import Console
from rich.live import Live
from rich.text import Text

from scenarios.supervisor import Progress

PLAIN_EVERY_S = 5.0


class ProgressShow:
    """Shows progress on standard error."""

    def __init__(self, name: str, seed: int, *, quiet: bool) -> None:
        self._title = f"{name}, seed {seed}"
        self._console = Console(stderr=True, quiet=quiet, highlight=False)
        self._live = Live(console=self._console, refresh_per_second=5, transient=True)
        self._said_s = 0.0

    def __enter__(self) -> Self:
        if self._console.is_terminal:
            self._live.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        where: TracebackType | None,
    ) -> None:
        self._live.stop()

    def update(self, progress: Progress) -> None:
        """Show where the run is now."""
        if self._console.is_terminal:
            self._live.update(Text(f"{self._title}: {_words(progress)}\n{_states(progress)}"))
        elif time.monotonic() - self._said_s > PLAIN_EVERY_S:
            self._said_s = time.monotonic()
            self._console.print(f"{self._title}: {_words(progress)}", soft_wrap=True)


def _words(progress: Progress) -> str:
    if not progress.started:
        ready = sum(state == "ready" for state in progress.states.values())
        return f"starting, {ready} of {len(progress.states)} processes ready"
    hours, rest = divmod(int(progress.simulated_s), 3600)
    return (
        f"{hours}:{rest // 60:02}:{rest % 60:02} simulated, "
        f"errands {progress.errands_done}/{progress.errands}, "
        f"decisions {progress.on_time} on time, {progress.late} late"
    )


def _states(progress: Progress) -> str:
    """Every process, by state."""
    states = progress.states
    return "; ".join(
        f"{state}: {', '.join(name for name in states if states[name] == state)}"
        for state in dict.fromkeys(states.values())
    )
