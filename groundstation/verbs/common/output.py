"""What a verb prints: data to stdout, as aligned text or JSON lines; progress and errors to stderr."""

from __future__ import annotations

import json
import math
import sys
import time
from typing import TYPE_CHECKING, Any

from dialects.printable import printable

if TYPE_CHECKING:  # it loads the dialect, which a program that only prints does without
    from groundstation.speech.voice import Voice
    from groundstation.vehicles.requests.requests import RequestReport

PROGRESS_PERIOD = 0.1
"""s between two progress lines."""


class Output:
    """Prints for one verb. `verb` names it in JSON, e.g. "param get"."""

    def __init__(self, verb: str, *, as_json: bool, quiet: bool) -> None:
        self.verb = verb
        self.as_json = as_json
        self._quiet = quiet
        self._began = time.monotonic()
        self._shows_progress = sys.stderr.isatty() and not quiet
        self._progress_due = 0.0
        self.voice: Voice | None = None
        """What speaks and rings; None: silent."""
        self._progress_shown = False

    def line(self, text: str) -> None:
        """Print one or more lines of data, unless --json. Escape sequences in texts of a vehicle become harmless."""
        if not self.as_json:
            self.clear_progress()
            sys.stdout.writelines(f"{printable(line)}\n" for line in text.split("\n"))

    def record(self, **fields: Any) -> None:
        """Print an object with --json."""
        if self.as_json:
            self.clear_progress()
            sys.stdout.write(json.dumps(_finite(fields)) + "\n")

    def announce(self, priority: int, text: str) -> None:
        """Say a text, where that is asked for."""
        if self.voice is not None:
            from groundstation.speech.announcements import Announcement, Priority  # a verb that is silent does without

            self.voice.say(Announcement(Priority(priority), text))

    def flush(self) -> None:
        """Pass on what was printed: somebody watches."""
        sys.stdout.flush()

    def result(self, ok: bool, vehicle: int | None, **fields: Any) -> None:
        """Print how the verb ended, with --json."""
        took = round(time.monotonic() - self._began, 3)
        self.record(ok=ok, verb=self.verb, vehicle=vehicle, **fields, took=took)

    def note(self, text: str) -> None:
        """Print a note to stderr, unless --quiet."""
        if not self._quiet:
            self.error(text)

    def error(self, text: str) -> None:
        """Print an error to stderr, one line."""
        self.clear_progress()
        sys.stdout.flush()
        sys.stderr.write(f"mavhelm: {printable(' '.join(text.split()))}\n")
        sys.stderr.flush()

    def progress(self, report: RequestReport) -> None:
        """Show how a request stands, on a terminal only."""
        now = time.monotonic()
        if not self._shows_progress or report.state.ended or now < self._progress_due:
            return
        self._progress_due = now + PROGRESS_PERIOD
        self.count(report.what, report.done, report.total)

    def count(self, what: str, done: int, total: int | None) -> None:
        """Show how many of a total are done, on a terminal only."""
        if not self._shows_progress:
            return
        counted = "..." if total is None and not done else f"{done}" if total is None else f"{done}/{total}"
        sys.stderr.write(f"\r\x1b[K{printable(what)} {counted}")
        sys.stderr.flush()
        self._progress_shown = True

    def clear_progress(self) -> None:
        """Remove the line of the progress, so that the next one begins at its start."""
        if self._progress_shown:
            sys.stderr.write("\r\x1b[K")
            sys.stderr.flush()
            self._progress_shown = False


def _finite(value: Any) -> Any:
    """Return the value as JSON can hold it: numbers that are not finite become null."""
    if isinstance(value, dict):
        return {key: _finite(each) for key, each in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(each) for each in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def ring_bell() -> None:
    """Ring the bell of the terminal, if there is one; what is printed is left as it is."""
    if sys.stderr.isatty():
        sys.stderr.write("\a")
        sys.stderr.flush()
