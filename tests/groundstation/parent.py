"""A screen process to kill: starts a station, arms, holds a key, prints the station's pid. Run as `python -m`."""

from __future__ import annotations

import sys
import threading

from tests.groundstation.screen import Screen

if __name__ == "__main__":
    screen = Screen(sys.argv[1], keep="--keep" in sys.argv)
    screen.hold_forward()
    print(screen.client.pid, flush=True)
    threading.Event().wait()
