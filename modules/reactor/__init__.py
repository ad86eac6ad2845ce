"""What to do about an approaching object."""

from modules.reactor.react import Reaction, react
from modules.reactor.tables import Settings
from modules.reactor.track import Scan, ScanError, Tracker, updated

__all__ = ["Reaction", "Scan", "ScanError", "Settings", "Tracker", "react", "updated"]
