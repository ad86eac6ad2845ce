"""Saying that a command failed: in words on standard error, as JSON where that was asked for."""

from __future__ import annotations

import json
import sys


def refuse(error: object, status: int, *, as_json: bool) -> int:
    """Say what is wrong; returns the exit status."""
    print(f"waywiser: {error}", file=sys.stderr)
    if as_json:
        print(json.dumps({"status": status, "error": str(error)}))
    return status
