"""CallOutput: what a verb prints, sent to the program that has called it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from groundstation.rover.protocol import CallNote, CallRecord
from groundstation.vehicles.requests.requests import RequestReport


class CallOutput:
    """Has the methods of Output. `send` takes what goes to the program."""

    as_json = True

    def __init__(self, call: int, verb: str, send: Callable[[object], None]) -> None:
        self._call, self._send = call, send
        self.verb = verb
        self.error_text = ""
        """The newest error."""
        self.fields: dict[str, Any] = {}
        """What the verb says about its end."""

    def line(self, text: str) -> None:
        """Leave out lines for a person: the same is in records."""

    def record(self, **fields: Any) -> None:
        """Send an object."""
        self._send(CallRecord(self._call, fields))

    def result(self, ok: bool, vehicle: int | None, **fields: Any) -> None:
        """Keep how the verb ended."""
        self.fields = {"ok": ok, **fields}

    def announce(self, priority: int, text: str) -> None:
        """Leave out speech."""

    def flush(self) -> None:
        """Do nothing: all is sent at once."""

    def note(self, text: str) -> None:
        """Send a note."""
        self._send(CallNote(self._call, text))

    def error(self, text: str) -> None:
        """Keep an error, and send it as a note."""
        self.error_text = text
        self.note(text)

    def progress(self, report: RequestReport) -> None:
        """Leave out the progress."""

    def count(self, what: str, done: int, total: int | None) -> None:
        """Leave out the progress."""

    def clear_progress(self) -> None:
        """Do nothing."""
