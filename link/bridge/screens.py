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
from link.bridge.status import Status
from link.protocol.link_events import UpsAndDowns

log = logging.getLogger(__name__)


class Screen:
    """Hands each status to `draw` in a thread of its own; `draw` may block, and ends the screen by OSError."""

    def __init__(self, draw: Callable[[Status], None]) -> None:
        self._draw = draw
        self._mailbox: queue.Queue[Status] = queue.Queue(1)
        threading.Thread(target=self._run, name="screen", daemon=True).start()

    def show(self, status: Status) -> None:
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


def print_json(status: Status) -> None:
    """One line on stdout. Raises OSError when nobody reads."""
    line = json.dumps({"time": round(time.time(), 3), **status.plain()})
    os.write(sys.stdout.fileno(), line.encode() + b"\n")


class Teller:
    """Logs what goes wrong and when it is right again, once each."""

    def __init__(self) -> None:
        self._links = UpsAndDowns()

    def show(self, status: Status) -> None:
        """Say what has changed."""
        for link in status.links:
            why = link.problem and link.problem.removeprefix(f"{link.endpoint}: ")
            if news := self._links.news(link.endpoint, why):
                level = logging.WARNING if news.severity <= Severity.ERROR else logging.INFO
                log.log(level, "%s: %s", link.endpoint, news.text)
