"""The common hobby ground station: keys set a state, a mavutil thread sends the state at a fixed rate.

A reference for key_to_motor.py, as good as this form allows (it reads the descriptor and loses no key).

Usage: python -m tests.benchmarks.hobby_ground ENDPOINT RATE
"""

from __future__ import annotations

import importlib
import os
import sys
import termios
import threading
import tty
from typing import Any

mavutil: Any = importlib.import_module("pymavlink.mavutil")

FULL = 1000
KEYS = {b"i": (FULL, 0), b"w": (FULL, 0), b"k": (0, 0), b" ": (0, 0)}
"""Key -> x and r of MANUAL_CONTROL."""


class Sender(threading.Thread):
    """Sends the newest state every `period` s, changed or not."""

    def __init__(self, connection: Any, period: float) -> None:
        super().__init__(daemon=True)
        self.state = (0, 0)
        self.ending = threading.Event()
        self._connection = connection
        self._period = period

    def run(self) -> None:
        """Send until `ending`."""
        while not self.ending.wait(self._period):
            x, r = self.state
            self._connection.mav.manual_control_send(1, x, 0, 0, r, 0)


def main(endpoint: str, rate: float) -> None:
    """Wait for a vehicle, then drive it until `q`."""
    connection = mavutil.mavlink_connection(endpoint, source_system=255)
    connection.wait_heartbeat()
    sender = Sender(connection, 1 / rate)
    sender.start()
    before = termios.tcgetattr(0)
    tty.setraw(0)
    try:
        os.write(1, b"ready\r\n")
        _read_keys(sender)
    finally:
        sender.ending.set()
        termios.tcsetattr(0, termios.TCSADRAIN, before)


def _read_keys(sender: Sender) -> None:
    while (key := os.read(0, 1)) not in (b"q", b""):
        sender.state = KEYS.get(key, sender.state)


if __name__ == "__main__":
    main(sys.argv[1], float(sys.argv[2]))
