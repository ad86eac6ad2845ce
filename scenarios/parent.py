"""A supervised process ends when its supervisor does, however that ends."""

from __future__ import annotations

import os
import threading


def end_with_parent() -> None:
    """Leave as soon as the supervisor's end of our standard input closes."""

    def watch() -> None:
        # Not sys.stdin: its lock, held by this thread, would hang the interpreter's own end.
        while os.read(0, 1):
            pass
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()
