"""What the vehicle tells of the program and the computer that it is; the daemon knows it (vehicle/runtime/host_info.py)."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(slots=True)
class HostInfo:
    """Unknown unless somebody says it."""

    uid: bytes = b""
    """16 bytes that are this computer's and no other's; empty: unknown."""
    load: float = 0.0
    """Share of the control loop's time that was used in the last second, 0..1."""
    epoch: float | None = None
    """Unix time, s, at the monotonic clock's zero. It changes: most Pis ask the network what time it is."""

    def unix_time(self, now: float) -> float | None:
        """s since 1970 at `now`, where the computer knows it."""
        return None if self.epoch is None else self.epoch + now
