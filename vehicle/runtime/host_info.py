"""Reads the computer's id and wall clock and measures the load of the loop, for vehicle/telemetry/host.py."""

from __future__ import annotations

import contextlib
import hashlib
import hmac
import re
from collections.abc import Callable
from pathlib import Path

from vehicle.telemetry.host import HostInfo

APPLICATION = bytes.fromhex("6d41a9f2c07b4c1e9d5be0a1187f3c52")
"""Random id of this application. It must never change, because the id of every vehicle depends on it."""
PERIOD = 1.0
"""s between two updates."""


def read_uid(root: Path = Path("/")) -> bytes:
    """Return 16 bytes that identify this computer, empty if it has no id. `root` is for tests.

    The content of /etc/machine-id is confidential (https://www.freedesktop.org/software/systemd/man/machine-id.html),
    so the result is its keyed hash, as computed by sd_id128_get_machine_app_specific, which cannot be reversed.
    """
    text = ""
    with contextlib.suppress(OSError, UnicodeDecodeError):
        text = (root / "etc/machine-id").read_text("ascii").strip()
    if not re.fullmatch("[0-9a-f]{32}", text) or not int(text, 16):
        return b""  # the file also contains "uninitialized" at the first boot
    uid = bytearray(hmac.new(bytes.fromhex(text), APPLICATION, hashlib.sha256).digest()[:16])
    uid[6], uid[8] = uid[6] & 0x0F | 0x40, uid[8] & 0x3F | 0x80  # marked as UUID version 4, like systemd
    return bytes(uid)


class HostMonitor:
    """Updates load and epoch of a HostInfo."""

    def __init__(
        self, host: HostInfo, waited: Callable[[], float], wall_clock: Callable[[], float], now: float
    ) -> None:
        """Start measuring. `waited` returns the total idle time of the loop in s, `wall_clock` the Unix time in s."""
        self._host = host
        self._waited = waited
        self._wall_clock = wall_clock
        self._last = (now, waited())
        host.epoch = wall_clock() - now

    def update(self, now: float) -> None:
        """Update the host info once every PERIOD. Called in each control cycle."""
        at, waited = self._last
        if now - at < PERIOD:
            return
        self._last = now, self._waited()
        self._host.epoch = self._wall_clock() - now
        self._host.load = min(1.0, max(0.0, 1.0 - (self._last[1] - waited) / (now - at)))
