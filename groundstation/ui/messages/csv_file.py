"""MessageCsv: writes each message of one kind to a CSV file while the Messages screen is open."""

from __future__ import annotations

import contextlib
import time
from pathlib import Path
from typing import TextIO

from groundstation.views.messages import CapturePage, CaptureRequest, MessageRequest

MAX_SIZE = 100_000_000
"""Characters after which the file ends."""


class MessageCsv:
    """At most one file at a time, in `folder`."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._file: TextIO | None = None
        self._path = Path()
        self._message: MessageRequest | None = None
        self._state, self._rows, self._size, self._lost = 0, 0, 0, 0

    @property
    def request(self) -> CaptureRequest | None:
        """Request for further lines; None while no file is written."""
        wanted = self._message
        if self._file is None or wanted is None:
            return None
        return CaptureRequest(wanted.system, wanted.component, wanted.sent, wanted.name, self._state)

    @property
    def status(self) -> str:
        """What is being written; empty without a file."""
        return "" if self._file is None else f"{self._rows} rows to {self._path.name}, S ends it"

    def toggle(self, message: MessageRequest | None) -> str:
        """Begin a file for a message, or end the one that is written; return how that went."""
        if self._file is not None:
            return self.close()
        if message is None:
            return "choose a message with ↑ ↓, then S writes it to a file"
        if message.name.startswith("#"):
            return f"{message.name} is in no dialect known here: it has no fields to save"
        name = f"{message.name}-{message.system}-{message.component}"
        self._path = self._folder / time.strftime(f"{name}-%Y%m%d-%H%M%S.csv")
        try:
            self._file = self._path.open("x", encoding="utf-8", newline="")
        except OSError as error:
            return f"not saved: {error.strerror}: {self._path}"
        self._message, self._state, self._rows, self._size, self._lost = message, 0, 0, 0, 0
        return f"writing {message.name} to {self._path}; S ends it"

    def add(self, page: CapturePage) -> str | None:
        """Write the lines of a page; return what the user must know, which ends the file."""
        if self._file is None or page.after != self._state:
            return None
        head = "" if self._rows else page.titles + "\n"
        text = head + "".join(line + "\n" for line in page.lines)
        try:
            self._file.write(text)
            self._file.flush()
        except OSError as error:
            return f"{error.strerror}: {self.close()}"
        self._state, self._rows, self._size = page.state, self._rows + len(page.lines), self._size + len(text)
        self._lost += page.lost
        return f"file is full: {self.close()}" if self._size >= MAX_SIZE else None

    def close(self) -> str:
        """End the file; return what it has."""
        file, self._file = self._file, None
        if file is None:
            return ""
        with contextlib.suppress(OSError):  # what was not written is lost; `add` has reported why
            file.close()
        lost = f", {self._lost} messages were too many and are missing" if self._lost else ""
        return f"{self._rows} rows in {self._path}{lost}"
