"""A debugger for a module that is replayed: Python's own, where it matters."""

from __future__ import annotations

import sys
from bdb import BdbQuit
from collections.abc import Mapping
from pdb import Pdb
from typing import Any

from bus.turns import Handler, Module, Turn
from logs.diff.found import FirstDifference
from logs.diff.words import duration


class _Terminal(Pdb):
    """Remembers whether it was left for good, which ``runcall`` keeps to itself."""

    left = False

    def set_quit(self) -> None:
        self.left = True
        super().set_quit()


class Debugger:
    """Breaks at the first difference, at an exception, or in the first handler from a time on.

    ``from_ns``: the simulated time of that handler (None: no such break). It talks on the
    standard output of its beginning: what handlers print there is caught.
    """

    def __init__(self, from_ns: int | None) -> None:
        self._from_ns = from_ns
        self._pdb = _Terminal(stdout=sys.stdout)

    def of_module(self, module: Module) -> Module:
        """The module, its handlers run under the debugger from the time on."""
        return _Watched({topic: self._watched(of) for topic, of in module.handlers.items()})

    def _watched(self, handler: Handler) -> Handler:
        def run(message: Any, turn: Turn) -> None:
            if self._from_ns is None or turn.start_ns < self._from_ns:
                handler(message, turn)
                return
            self._from_ns = None
            self._say(f"handling message {turn.heard} at {duration(turn.start_ns)}")
            self._pdb.runcall(handler, message, turn)
            if self._pdb.left:  # or a handler that was left in its middle would count
                raise BdbQuit

        return run

    def differs(self, first: FirstDifference) -> None:
        """Break in the caller, where both sides of the difference can be looked at."""
        self._say(f"the first difference, at {duration(first.at_ns)}: {first.what}")
        self._say("here: turn (as logged), heard, said (now), self.worker; to step through the")
        self._say("handler itself start again with --until, just before it began")
        self._pdb.set_trace(sys._getframe().f_back)

    def failed(self, error: Exception) -> None:
        """Look at where an exception was raised."""
        self._say(f"{type(error).__name__}: {error}")
        self._pdb.reset()
        self._pdb.interaction(None, error.__traceback__)

    def _say(self, text: str) -> None:
        print(text, file=self._pdb.stdout)


class _Watched:
    def __init__(self, handlers: Mapping[str, Handler]) -> None:
        self.handlers = handlers
