"""The features that detectors look for, and the wedges in which they look (paper, section 3).

A *detector* d_{f,w} has the code ``feature * WEDGES + wedge``; wedge k is centred k * 45 degrees
counter-clockwise from the heading on exit from the port.
"""

from __future__ import annotations

FEATURES = ("opening", "flat_wall", "convex_corner")
OPENING, FLAT_WALL, CONVEX_CORNER = range(3)
WEDGES = 8
DETECTORS = len(FEATURES) * WEDGES
