"""What viewers show of a run without a plug-in: ``foxglove.*`` messages beside our own.

Positions are metres in the frame ``building`` (x east, y north); the frame ``robot`` moves in it
with truth/pose, x ahead. Every view is made from one message, so it repeats bit for bit.
"""

from logs.views.views import VIEWS, Views

__all__ = ["VIEWS", "Views"]
