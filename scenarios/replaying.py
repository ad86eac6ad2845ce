"""The replay command: one module of the working tree, fed what it heard in a recorded run."""

from __future__ import annotations

import json
import time
from bdb import BdbQuit
from dataclasses import asdict
from pathlib import Path

from bus.topics import MODULES
from bus.turns import Worker
from logs.diff.report import first_lines
from logs.diff.words import duration
from logs.reader import LogReadError, RunReader, read_run
from logs.replay.replay import Replay, Replayed
from logs.replay.turns import LoggedModule
from scenarios.commands import BAD_INPUT, FAILED, GOOD, INCONCLUSIVE
from scenarios.debugger import Debugger
from scenarios.explain import one_of
from scenarios.modules import ModuleRefusedError, build_module
from scenarios.parts import PartsError, parts_in
from scenarios.say import refuse

LISTED = 10


class ReplayError(ValueError):
    """What was asked for cannot be replayed: found, expected."""


def replay(
    log: Path, module: str, until_ns: int | None = None, debugger: Debugger | None = None
) -> Replayed:
    """Replay one module of a recorded run, up to a time if one is given.

    Raises ReplayError for a module that there is not, LogReadError and PartsError for a log
    that cannot be replayed, ModuleRefusedError.
    """
    if module not in MODULES:
        raise ReplayError(f"--module: found {module!r}, {one_of(module, sorted(MODULES))}")
    with read_run(log) as reader:
        worker = _worker(reader, module, debugger)
        return Replay(LoggedModule(module, reader), worker, debugger, until_ns).run(_hop_ns(reader))


def _worker(reader: RunReader, module: str, debugger: Debugger | None) -> Worker:
    parts = parts_in(reader.attachments, str(reader.path))
    built = build_module(module, parts.facts, parts.settings.get(module, {}), parts.seed)
    if debugger is not None:
        built = debugger.of_module(built)
    return Worker(module, built, parts.prices.costs)


def _hop_ns(reader: RunReader) -> int:
    text = reader.metadata.get("hop_ns", "nothing")
    if not text.isdecimal():
        raise LogReadError(f"{reader.path}: metadata hop_ns: found {text!r}, expected nanoseconds")
    return int(text)


def replay_command(
    log: Path, module: str, until_s: float | None, debug: bool, as_json: bool
) -> int:
    """Carry out ``waywiser replay``; returns the exit status."""
    if debug and as_json:
        return refuse("--pdb: found beside --json, expected one of them", BAD_INPUT, as_json=True)
    until_ns = None if until_s is None else round(until_s * 1e9)
    debugger = Debugger(until_ns) if debug else None
    began_s = time.monotonic()
    try:
        replayed = replay(log, module, None if debug else until_ns, debugger)
    except (ReplayError, LogReadError, PartsError, ModuleRefusedError) as error:
        return refuse(error, BAD_INPUT, as_json=as_json)
    except BdbQuit:
        return refuse("left the debugger, nothing was compared", INCONCLUSIVE, as_json=as_json)
    status = _status(replayed)
    if as_json:
        print(json.dumps({"status": status, "log": str(log), **asdict(replayed)}))
    else:
        print("\n".join(_lines(replayed, time.monotonic() - began_s)))
    return status


def _status(replayed: Replayed) -> int:
    if replayed.first is not None:
        return FAILED
    return INCONCLUSIVE if replayed.incomplete else GOOD


def _lines(replayed: Replayed, took_s: float) -> list[str]:
    lines = [
        f"{replayed.module}: {replayed.handlers:,} handlers up to {replayed.until_ns / 1e9:,.3f} s "
        f"run again in {took_s:.1f} s, {replayed.said:,} messages compared"
    ]
    if replayed.first is None:
        lines.append("no difference: all that it says is as in the log, bit for bit")
    else:
        kinds = ", ".join(f"{kind} {number:,}" for kind, number in replayed.kinds.items())
        lines.append(f"{replayed.unlike:,} handlers do something else than in the log ({kinds})")
        lines.append(f"the first at {duration(replayed.first.at_ns)}")
        lines += first_lines(replayed.first)
    lines += [
        f"{one.topic} (message {one.sequence}), said at {one.said_ns / 1e9:,.3f} s: "
        f"{', '.join(one.flips)}"
        for one in replayed.flipped[:LISTED]
    ]
    if len(replayed.flipped) > LISTED:
        lines.append(f"and {len(replayed.flipped) - LISTED:,} more that choose otherwise")
    if replayed.last_turn:
        lines.append(f"its next turn, of which the log has no end: {replayed.last_turn}")
    return lines + [f"not all is there: {reason}" for reason in replayed.incomplete]
