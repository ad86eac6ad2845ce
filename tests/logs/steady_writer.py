"""Writes messages without end and says, line by line, how many it has handed to the log.

``python -m tests.logs.steady_writer LOG``, from the repository's root; to be killed.
"""

from __future__ import annotations

import sys

from logs.run_log import RunLog
from tests.logs.endless_run import EPOCH_NS, message


def main(path: str) -> None:
    log = RunLog(path, EPOCH_NS, {"seed": "1"}, {})
    sequence = 0
    while True:
        log.write(message(sequence, 10**9))
        sequence += 1
        print(sequence, flush=True)


if __name__ == "__main__":
    main(sys.argv[1])
