"""The one path that carries the demands to a vehicle of another make.

Its demands carry no proof, so that it cannot tell a late copy from a new one. The path
changes after a silence only, so that frames that wait in a slow link do not meet those of a fast one.
"""

from __future__ import annotations

from groundstation.vehicles.paths.path import Path


class Carrier:
    """The path of the demands to one vehicle."""

    def __init__(self) -> None:
        self.path: Path | None = None
        """None before the first demand."""

    def follow(self, best: Path, now: float, silence: float) -> bool:
        """Take the best path if the present one was silent for `silence` s; return whether it has changed."""
        before = self.path
        if before is best or (before is not None and now - before.heard_at <= silence):
            return False
        self.path = best
        return before is not None
