"""Finds out what vehicle/telemetry/host.py tells: the computer's id and its wall clock, and how busy the loop is."""

from __future__ import annotations

import contextlib
import hashlib
import hmac
import re
from collections.abc import Callable
from pathlib import Path

from vehicle.telemetry.host import HostInfo

APPLICATION = bytes.fromhex("6d41a9f2c07b4c1e9d5be0a1187f3c52")
"""Ours alone, made by chance; it never changes, or every vehicle would be another one."""
PERIOD = 1.0
"""s between two looks."""


def read_uid(root: Path = Path("/")) -> bytes:
    """16 bytes that stay the same on this computer, empty where it has no id. `root` is for tests.

    /etc/machine-id is to be kept to oneself (its manual page): what is told is its keyed hash, made as
    sd_id128_get_machine_app_specific makes it, from which it cannot be had back.
    """
    text = ""
    with contextlib.suppress(OSError, UnicodeDecodeError):
        text = (root / "etc/machine-id").read_text("ascii").strip()
    if not re.fullmatch("[0-9a-f]{32}", text) or not int(text, 16):
        return b""  # also "uninitialized", at a first boot
    uid = bytearray(hmac.new(bytes.fromhex(text), APPLICATION, hashlib.sha256).digest()[:16])
    uid[6], uid[8] = uid[6] & 0x0F | 0x40, uid[8] & 0x3F | 0x80  # a UUID of version 4, as systemd says it
    return bytes(uid)


class HostMonitor:
    """Keeps what changes of a Host: its load and its epoch."""

    def __init__(
        self, host: HostInfo, waited: Callable[[], float], wall_clock: Callable[[], float], now: float
    ) -> None:
        """`waited`: s that the loop has had nothing to do, so far; `wall_clock`: Unix time, s."""
        self._host = host
        self._waited = waited
        self._wall_clock = wall_clock
        self._before = (now, waited())
        host.epoch = wall_clock() - now

    def update(self, now: float) -> None:
        """Called in each control cycle."""
        at, waited = self._before
        if now - at < PERIOD:
            return
        self._before = now, self._waited()
        self._host.epoch = self._wall_clock() - now
        self._host.load = min(1.0, max(0.0, 1.0 - (self._before[1] - waited) / (now - at)))
