"""SentOutput: what a verb prints, sent to the shell in which it was typed."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

from groundstation.station_socket.verb_run import Printed
from groundstation.vehicles.requests.requests import RequestReport
from groundstation.verbs.common.output import PROGRESS_PERIOD, Output


class SentOutput(Output):
    """Has the methods of Output, and prints nothing here. The Output of the shell gets the same calls."""

    def __init__(self, verb: str, *, as_json: bool, send: Callable[[Printed], None]) -> None:
        super().__init__(verb, as_json=as_json, quiet=False)
        self._send = send

    def line(self, text: str) -> None:
        """Send lines of data, unless --json."""
        if not self.as_json:
            for line in text.split("\n"):
                self._send(Printed("line", (line,)))

    def record(self, **fields: Any) -> None:
        """Send an object with --json."""
        if self.as_json:
            self._send(Printed("record", (), fields))

    def result(self, ok: bool, vehicle: int | None, **fields: Any) -> None:
        """Send how the verb ended, with --json."""
        if self.as_json:
            self._send(Printed("result", (ok, vehicle), fields))

    def flush(self) -> None:
        """Have the shell pass on what was printed."""
        self._send(Printed("flush"))

    def note(self, text: str) -> None:
        """Send something worth knowing."""
        self._send(Printed("note", (text,)))

    def error(self, text: str) -> None:
        """Send an error."""
        self._send(Printed("error", (text,)))

    def progress(self, report: RequestReport) -> None:
        """Send how a request stands, ten times a second at most."""
        now = time.monotonic()
        if not report.state.ended and now >= self._progress_due:
            self._progress_due = now + PROGRESS_PERIOD
            self.count(report.what, report.done, report.total)

    def count(self, what: str, done: int, total: int | None) -> None:
        """Send how many of a total are done."""
        self._send(Printed("count", (what, done, total)))
