"""The recover command."""

from __future__ import annotations

import json
import sys
from dataclasses import asdict
from pathlib import Path

from logs.reader import LogReadError
from logs.recover import Recovered, recover
from logs.run_log import LogWriteError
from scenarios.commands import BAD_INPUT, GOOD, INCONCLUSIVE


def recover_command(log: Path, out: Path, as_json: bool) -> int:
    """Carry out ``waywiser recover``; returns the exit status."""
    try:
        recovered = recover(log, out)
    except (LogReadError, LogWriteError) as error:
        print(f"waywiser: {error}", file=sys.stderr)
        return BAD_INPUT
    status = GOOD if recovered.whole else INCONCLUSIVE
    if as_json:
        print(json.dumps({"status": status, "log": str(out), **asdict(recovered)}))
    else:
        print("\n".join(_words(recovered, out)))
    return status


def _words(recovered: Recovered, out: Path) -> list[str]:
    kept = f"{recovered.messages:,} messages kept, {recovered.from_tail:,} of them from the tail"
    missing = [
        f"{number:,} of the messages of {source} are missing before its last one"
        for source, number in recovered.missing.items()
    ]
    end = [] if recovered.ended else ["the log does not say how the run ended: its end is missing"]
    lines = [kept, *recovered.damage, *missing, *end]
    if recovered.whole:
        lines.append("the run is all there")
    return [*lines, f"log: {out}"]
