"""Notifications to systemd (sd_notify): ready, watchdog, stopping; no effect if systemd did not start the daemon.

The watchdog is fed after completed control cycles only, not by a timer, so that it ends a loop that hangs or runs
without driving. Protocol: https://www.freedesktop.org/software/systemd/man/sd_notify.html
"""

from __future__ import annotations

import contextlib
import math
import os
import socket
from collections.abc import Mapping

WATCHDOG_DIVISOR = 4
"""Notifications of a healthy daemon per watchdog timeout: with 1 s, one each 0.25 s, while a cycle takes 0.02 s."""


class Notifier:
    """Sends to the socket that systemd sets in the environment."""

    def __init__(self, environment: Mapping[str, str] = os.environ) -> None:
        self._socket = _connected(environment.get("NOTIFY_SOCKET", ""))
        self._period = _watchdog(environment) / WATCHDOG_DIVISOR
        self._due = -math.inf

    def ready(self, status: str) -> None:
        """Report that everything is open and the control loop runs."""
        self._send(f"READY=1\nSTATUS={status}")

    def alive(self, now: float) -> None:
        """Feed the watchdog, if due, after a control cycle completed at `now`."""
        if now >= self._due and self._period < math.inf:
            self._due = now + self._period
            self._send("WATCHDOG=1")

    def stopping(self) -> None:
        """Report that the motors are stopped and the daemon ends."""
        self._send("STOPPING=1")

    def close(self) -> None:
        """Close the socket."""
        if self._socket is not None:
            self._socket.close()
            self._socket = None

    def _send(self, text: str) -> None:
        if self._socket is not None:
            with contextlib.suppress(OSError):  # no receiver, or a full buffer: the loop does not wait
                self._socket.send(text.encode())


def _connected(address: str) -> socket.socket | None:
    if not address:
        return None
    notify = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
    notify.setblocking(False)
    try:
        notify.connect("\0" + address[1:] if address.startswith("@") else address)
    except OSError:
        notify.close()
        return None
    return notify


def _watchdog(environment: Mapping[str, str]) -> float:
    """Return the timeout of the watchdog in s; infinite without one, or if it is for another process."""
    microseconds = environment.get("WATCHDOG_USEC", "")
    ours = environment.get("WATCHDOG_PID", str(os.getpid())) == str(os.getpid())
    return int(microseconds) / 1e6 if ours and microseconds.isascii() and microseconds.isdigit() else math.inf
