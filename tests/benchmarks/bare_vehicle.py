"""The least that a vehicle in Python can do with a demand: receive it by UDP, set the motors.

A reference for key_to_motor.py. It writes the log that `mavhelm vehicle --motor-log` writes.

Usage: python -m tests.benchmarks.bare_vehicle PORT MOTOR_LOG
"""

from __future__ import annotations

import os
import socket
import sys
import time


def main(port: int, motor_log: str) -> None:
    """Run until killed."""
    log = os.open(motor_log, os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o644)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        sock.bind(("127.0.0.1", port))
        while True:
            throttle = float(sock.recv(64))
            os.write(log, f"{time.monotonic_ns()} {throttle:.4f} {throttle:.4f}\n".encode())


if __name__ == "__main__":
    main(int(sys.argv[1]), sys.argv[2])
