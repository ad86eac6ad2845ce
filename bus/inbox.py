"""What a process has received: payloads wait here until a grant names them."""

from __future__ import annotations

from bus.wire import MessageId, Sent


class GapError(RuntimeError):
    """A message was lost on its way: which, between which two."""


class LostPayloadError(RuntimeError):
    """Payloads that a grant names did not come: which, to whom, when."""

    def __init__(
        self, process: str, time_ns: int, missing: list[MessageId], patience_s: float
    ) -> None:
        super().__init__(
            f"{process}: granted {missing} at {time_ns} ns, "
            f"but they did not come within {patience_s:g} s"
        )


class Inbox:
    """Payloads by (source, sequence), with an eye on gaps.

    Each payload names the one its source said before on the same topic; what is not the one
    seen last means that something was lost, and no honest run can go on.
    """

    def __init__(self) -> None:
        self._held: dict[MessageId, Sent] = {}
        self._last: dict[tuple[str, str], int] = {}

    def put(self, sent: Sent) -> None:
        """Keep a payload. Raises GapError if one before it never came."""
        stream = (sent.source, sent.topic)
        last = self._last.get(stream, -1)
        if sent.previous != last:
            raise GapError(
                f"{sent.topic} from {sent.source}: message {sent.sequence} follows "
                f"{sent.previous}, but the last one received was {last}"
            )
        self._last[stream] = sent.sequence
        self._held[sent.id] = sent

    def has(self, messages: tuple[MessageId, ...]) -> bool:
        """Whether all of these payloads are here."""
        return all(name in self._held for name in messages)

    def take(self, messages: tuple[MessageId, ...]) -> tuple[Sent, ...]:
        """The payloads named, in that order; they are kept no longer."""
        return tuple(self._held.pop(name) for name in messages)

    def missing(self, messages: tuple[MessageId, ...]) -> list[MessageId]:
        """Those of these payloads that are not here yet."""
        return [name for name in messages if name not in self._held]
