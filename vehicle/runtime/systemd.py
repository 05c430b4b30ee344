"""What systemd hears of the daemon (sd_notify): ready, alive, stopping; nothing where it was not started by systemd.

Alive is never said by a timer of its own: only whoever has just completed a control cycle may say it, so a loop that
hangs, or turns without driving, is ended by the watchdog.
"""

from __future__ import annotations

import contextlib
import math
import os
import socket
from collections.abc import Mapping

WATCHDOG_DIVISOR = 4
"""Times in a watchdog's time that it hears from a healthy daemon: with 1 s, each quarter, though a cycle is 0.02 s."""


class Notifier:
    """Speaks to the socket that systemd names in the environment."""

    def __init__(self, environment: Mapping[str, str] = os.environ) -> None:
        self._socket = _connected(environment.get("NOTIFY_SOCKET", ""))
        self._period = _watchdog(environment) / WATCHDOG_DIVISOR
        self._due = -math.inf

    def ready(self, status: str) -> None:
        """Everything is open, and the control loop runs."""
        self._send(f"READY=1\nSTATUS={status}")

    def alive(self, now: float) -> None:
        """A control cycle was completed at `now`."""
        if now >= self._due and self._period < math.inf:
            self._due = now + self._period
            self._send("WATCHDOG=1")

    def stopping(self) -> None:
        """The motors stand, the end has begun."""
        self._send("STOPPING=1")

    def close(self) -> None:
        """Say no more."""
        if self._socket is not None:
            self._socket.close()
            self._socket = None

    def _send(self, text: str) -> None:
        if self._socket is not None:
            with contextlib.suppress(OSError):  # nobody listens, or it is full: the loop does not wait for that
                self._socket.send(text.encode())


def _connected(address: str) -> socket.socket | None:
    if not address:
        return None
    speaker = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM | socket.SOCK_CLOEXEC | socket.SOCK_NONBLOCK)
    try:
        speaker.connect("\0" + address[1:] if address.startswith("@") else address)
    except OSError:
        speaker.close()
        return None
    return speaker


def _watchdog(environment: Mapping[str, str]) -> float:
    """S of the watchdog's time; infinite where there is none, or where it is meant for another process."""
    microseconds = environment.get("WATCHDOG_USEC", "")
    meant = environment.get("WATCHDOG_PID", str(os.getpid())) == str(os.getpid())
    return int(microseconds) / 1e6 if meant and microseconds.isascii() and microseconds.isdigit() else math.inf
