"""SentOutput: what a verb prints, sent to the shell in which it was typed."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from groundstation.station_socket.verb_run import Printed
from groundstation.verbs.common.output import Output


class SentOutput(Output):
    """Has the methods of Output, and prints nothing here. The Output of the shell gets the same calls."""

    def __init__(self, verb: str, *, as_json: bool, send: Callable[[Printed], None]) -> None:
        super().__init__(verb, as_json=as_json, quiet=False)
        self._send = send
        self._shows_progress = True  # the Output of the shell knows whether it is at a terminal

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

    def announce(self, priority: int, text: str) -> None:
        """Have the shell say a text."""
        self._send(Printed("announce", (priority, text)))

    def flush(self) -> None:
        """Have the shell pass on what was printed."""
        self._send(Printed("flush"))

    def note(self, text: str) -> None:
        """Send a note."""
        self._send(Printed("note", (text,)))

    def error(self, text: str) -> None:
        """Send an error."""
        self._send(Printed("error", (text,)))

    def count(self, what: str, done: int, total: int | None) -> None:
        """Send how many of a total are done."""
        self._send(Printed("count", (what, done, total)))
