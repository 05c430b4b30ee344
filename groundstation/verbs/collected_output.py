"""CollectedOutput: what a verb prints, kept: for one of many vehicles, or for a line of the screens."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from groundstation.vehicles.requests.requests import RequestReport


def one_line(text: str) -> str:
    """Return a text without line breaks."""
    return " ".join(text.split())


class CollectedOutput:
    """Has the methods of Output. `word` returns a note as it is kept."""

    as_json = False

    def __init__(self, word: Callable[[str], str] = one_line) -> None:
        self._word = word
        self.lines: list[str] = []
        """Data."""
        self.notes: list[str] = []
        """Notes and errors, one line each."""
        self.records: list[dict[str, Any]] = []
        """Data as objects."""
        self.fields: dict[str, Any] = {}
        """What the verb says about its end."""

    def words(self, name: str, *, brief: bool) -> tuple[str, ...]:
        """Return what the table shows: the data, then the notes, without the name of the vehicle in front.

        `brief`: of each note what stands before a semicolon; the advice behind it is for one vehicle.
        """
        notes = (each.removeprefix(name).removeprefix(":").strip() for each in self.notes)
        return (*self.lines, *(each.partition("; ")[0] if brief else each for each in notes))

    def line(self, text: str) -> None:
        """Handle lines of data."""
        self.lines += text.split("\n")

    def record(self, **fields: Any) -> None:
        """Handle an object."""
        self.records.append(fields)

    def result(self, ok: bool, vehicle: int | None, **fields: Any) -> None:
        """Note how the verb ended."""
        self.fields = {key: value for key, value in fields.items() if key not in ("text", "name")}

    def announce(self, priority: int, text: str) -> None:
        """Leave out speech."""

    def flush(self) -> None:
        """Do nothing."""

    def note(self, text: str) -> None:
        """Keep a note for the user."""
        self.notes.append(self._word(text))

    def error(self, text: str) -> None:
        """Keep an error."""
        self.note(text)

    def progress(self, report: RequestReport) -> None:
        """Ignore the progress: nobody sees it."""
