"""A screen process to kill: starts a station, arms, holds a key, prints the station's pid. Run as `python -m`.

Arguments: endpoints, --keep, and --record-to=FOLDER.
"""

from __future__ import annotations

import sys
import threading
from pathlib import Path

from groundstation.recording.options import RecordOptions
from tests.groundstation.screen import Screen

RECORD = "--record-to="

if __name__ == "__main__":
    words = sys.argv[1:]
    endpoints = [each for each in words if not each.startswith("--")]
    folder = next((Path(each.removeprefix(RECORD)) for each in words if each.startswith(RECORD)), None)
    record = None if folder is None else RecordOptions(folder, 100, 2000)
    screen = Screen(*endpoints, keep="--keep" in words, record=record)
    screen.hold_forward()
    print(screen.client.pid, flush=True)
    threading.Event().wait()
