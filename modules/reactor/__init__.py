"""What to do about an approaching object."""

from modules.reactor.react import Reaction, react
from modules.reactor.tables import Diagram, Settings, compiled
from modules.reactor.track import Scan, ScanError, Tracker, updated

__all__ = [
    "Diagram",
    "Reaction",
    "Scan",
    "ScanError",
    "Settings",
    "Tracker",
    "compiled",
    "react",
    "updated",
]
