"""What to do about an approaching object."""

from modules.reactor.diagram import Settings
from modules.reactor.react import Reaction, react
from modules.reactor.tables import Diagram, compiled
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
