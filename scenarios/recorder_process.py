"""The recorder's process: ``python -m scenarios.recorder_process ORDER``."""

from __future__ import annotations

import sys
from pathlib import Path

from bus import link
from bus.recording import Recording
from logs.run_log import LogWriteError
from logs.transcode import Taker
from scenarios.order import read_order
from scenarios.parent import end_with_parent

CANNOT_WRITE = 3


def main(order_path: str) -> int:
    """Write the run's log; 3 if it cannot be written or is not whole.

    Where it cannot be written, this process leaves at once, and that ends the run.
    """
    end_with_parent()
    order = read_order(order_path)
    try:
        with (
            order.script.open_log(Path(order.log)) as log,
            link.open_client(order.endpoint) as session,
        ):
            recording = Recording(session, link.Keys(order.run), Taker().take, log.record)
            recording.run()
    except LogWriteError as error:
        print(error, f"waywiser recover {order.log} OUT saves what is there", sep="\n", flush=True)
        return CANNOT_WRITE
    return CANNOT_WRITE if recording.lost else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
