"""The least that a ground station in Python can do with a key: read it from the terminal, send its demand by UDP.

A reference for key_to_motor.py: without screen, timers, checks and MAVLink.

Usage: python -m tests.benchmarks.bare_ground PORT
"""

from __future__ import annotations

import os
import socket
import sys
import termios
import tty

DEMANDS = {b"i": b"1.0", b"w": b"1.0", b"k": b"0.0", b" ": b"0.0"}
"""Key -> what is sent."""


def main(port: int) -> None:
    """Drive until `q`."""
    before = termios.tcgetattr(0)
    tty.setraw(0)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        sock.connect(("127.0.0.1", port))
        os.write(1, b"ready\r\n")
        while (key := os.read(0, 1)) not in (b"q", b""):
            if key in DEMANDS:
                sock.send(DEMANDS[key])
    termios.tcsetattr(0, termios.TCSADRAIN, before)


if __name__ == "__main__":
    main(int(sys.argv[1]))
