"""The common hobby vehicle: a mavutil loop that polls for messages at each tick and sets the motors.

A reference for key_to_motor.py. It has no ramps and no checks, so its path is as short as this form allows.

Usage: python -m tests.benchmarks.hobby_vehicle ENDPOINT TICK_SECONDS MOTOR_LOG
"""

from __future__ import annotations

import importlib
import os
import sys
import threading
import time
from typing import Any

mavutil: Any = importlib.import_module("pymavlink.mavutil")

HEARTBEAT_PERIOD = 1.0


class Motors:
    """Writes the log that `mavhelm vehicle --motor-log` writes."""

    def __init__(self, path: str) -> None:
        self._descriptor = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o644)
        self._now = (0.0, 0.0)

    def set(self, left: float, right: float) -> None:
        """Set both motors."""
        if (left, right) != self._now:
            self._now = (left, right)
            os.write(self._descriptor, f"{time.monotonic_ns()} {left:.4f} {right:.4f}\n".encode())


def main(endpoint: str, tick: float, motor_log: str) -> None:
    """Run until killed."""
    connection = mavutil.mavlink_connection(endpoint, source_system=1)
    motors, ticks, heartbeat_due = Motors(motor_log), threading.Event(), 0.0
    while not ticks.wait(tick):  # time.sleep(tick), in most of them
        if time.monotonic() >= heartbeat_due:
            heartbeat_due = time.monotonic() + HEARTBEAT_PERIOD
            connection.mav.heartbeat_send(10, 0, 0, 0, 4)
        while (message := connection.recv_match(type="MANUAL_CONTROL", blocking=False)) is not None:
            motors.set(_clamp(message.x + message.r), _clamp(message.x - message.r))


def _clamp(value: int) -> float:
    return max(-1.0, min(1.0, value / 1000))


if __name__ == "__main__":
    main(sys.argv[1], float(sys.argv[2]), sys.argv[3])
