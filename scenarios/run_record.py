"""What a log says of its run beside the messages: made the same way by every kind of run."""

from __future__ import annotations

from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path

from logs.run_log import RunLog
from scenarios.parts import ATTACHMENT, pack_parts, parts_of
from scenarios.scenario import Scenario

LIBRARIES = (
    "waywiser",
    "numpy",
    "numba",
    "simpy",
    "msgpack",
    "msgspec",
    "mcap",
    "protobuf",
    "zstandard",
)


@dataclass(frozen=True)
class Script:
    """A scenario as it was given: its name, its file's text, and the changes made to it."""

    name: str
    text: str
    changes: tuple[str, ...]
    scenario: Scenario

    def open_log(self, path: Path) -> RunLog:
        """The log of a run of this. Raises LogWriteError."""
        versions = ", ".join(f"{name} {version(name)}" for name in LIBRARIES)
        metadata = {
            "scenario": self.name,
            "about": self.scenario.about,
            "seed": str(self.scenario.seed),
            "changes": "\n".join(self.changes),
            "profile": self.scenario.compute.profile,
            "hop_ns": str(round(self.scenario.bus.hop_s * 1e9)),
            "versions": versions,
        }
        parts = pack_parts(parts_of(self.scenario))
        attachments = {"scenario.toml": self.text.encode(), ATTACHMENT: parts}
        return RunLog(path, self.scenario.epoch_ns, metadata, attachments)
