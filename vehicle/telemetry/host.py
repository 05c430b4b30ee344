"""The computer and the program, for telemetry; the daemon fills it in (vehicle/runtime/host_info.py)."""

from __future__ import annotations

import msgspec


class HostInfo(msgspec.Struct):
    """Facts about the host; the defaults mean unknown."""

    uid: bytes = b""
    """Unique id of this computer, 16 bytes; empty: unknown."""
    load: float = 0.0
    """Share of the control loop's time that was busy in the last second, 0..1."""
    epoch: float | None = None
    """Unix time in s at zero of the monotonic clock. It changes when NTP sets the clock."""

    def unix_time(self, now: float) -> float | None:
        """Return the Unix time in s at `now`; None if unknown."""
        return None if self.epoch is None else self.epoch + now
