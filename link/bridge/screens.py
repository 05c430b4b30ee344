"""Where the status goes: a live table on a terminal, a line of JSON a second, or only what goes wrong into the log.

A terminal or a pipe may block as long as it likes: a thread writes, and only the newest status waits for it.
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
    """Hands each status to `draw` in a thread of its own; `draw` may block, and ends the screen by OSError."""

    def __init__(self, draw: Callable[[BridgeStatus], None]) -> None:
        self._draw = draw
        self._mailbox: queue.Queue[BridgeStatus] = queue.Queue(1)
        threading.Thread(target=self._run, name="screen", daemon=True).start()

    def update(self, status: BridgeStatus) -> None:
        """Replace what waits to be drawn."""
        with contextlib.suppress(queue.Empty):
            self._mailbox.get_nowait()
        with contextlib.suppress(queue.Full):
            self._mailbox.put_nowait(status)

    def _run(self) -> None:
        try:
            while True:
                self._draw(self._mailbox.get())
        except OSError:
            log.warning("nobody reads the status any more; the bridge goes on")


def print_json(status: BridgeStatus) -> None:
    """One line on stdout. Raises OSError when nobody reads."""
    line = json.dumps({"time": round(time.time(), 3), **status.to_dict()})
    os.write(sys.stdout.fileno(), line.encode() + b"\n")


class StatusLogger:
    """Logs what goes wrong and when it is right again, once each."""

    def __init__(self) -> None:
        self._links = UpDownEvents()

    def update(self, status: BridgeStatus) -> None:
        """Say what has changed."""
        for link in status.links:
            why = link.problem and link.problem.removeprefix(f"{link.endpoint}: ")
            if event := self._links.update(link.endpoint, why):
                level = logging.WARNING if event.severity <= Severity.ERROR else logging.INFO
                log.log(level, "%s: %s", link.endpoint, event.text)
