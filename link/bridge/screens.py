"""Status outputs: a live table on a terminal, JSON lines, or a log of problems.

A terminal or a pipe may block for any time, so a thread writes, and only the newest status waits for it.
"""

from __future__ import annotations

import contextlib
import json
import logging
import os
import queue
import sys
import threading
import time
from collections.abc import Callable

from dialects.enums import Severity
from link.bridge.status import BridgeStatus
from link.protocol.link_events import UpDownEvents

log = logging.getLogger(__name__)


class StatusWriter:
    """Passes each status to `draw` in a thread; `draw` may block, and ends the output with an OSError."""

    def __init__(self, draw: Callable[[BridgeStatus], None]) -> None:
        self._draw = draw
        self._mailbox: queue.Queue[BridgeStatus] = queue.Queue(1)
        threading.Thread(target=self._run, name="screen", daemon=True).start()

    def update(self, status: BridgeStatus) -> None:
        """Replace the status that waits to be drawn."""
        with contextlib.suppress(queue.Empty):
            self._mailbox.get_nowait()
        with contextlib.suppress(queue.Full):
            self._mailbox.put_nowait(status)

    def _run(self) -> None:
        try:
            while True:
                self._draw(self._mailbox.get())
        except OSError:
            log.warning("the status output was closed; the bridge continues")


def print_json(status: BridgeStatus) -> None:
    """Print one line on stdout. Raises OSError when it was closed."""
    line = json.dumps({"time": round(time.time(), 3), **status.to_dict()})
    os.write(sys.stdout.fileno(), line.encode() + b"\n")


class StatusLogger:
    """Logs each problem once when it begins and once when it is over."""

    def __init__(self) -> None:
        self._links = UpDownEvents()

    def update(self, status: BridgeStatus) -> None:
        """Log what has changed."""
        for link in status.links:
            why = link.problem and link.problem.removeprefix(f"{link.endpoint}: ")
            if event := self._links.update(link.endpoint, why):
                level = logging.WARNING if event.severity <= Severity.ERROR else logging.INFO
                log.log(level, "%s: %s", link.endpoint, event.text)
