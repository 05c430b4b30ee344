"""The key of the Files and Replay screens that writes a log of this machine for other programs."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, Protocol

import msgspec

from groundstation.ui.base.local_files import short_path
from groundstation.ui.display.wrap import clean
from groundstation.ui.files.exports import LOG_SUFFIX, NAMES, ExportRequest, Exports, parse_request
from groundstation.ui.files.tables import percent_text
from groundstation.ui.widgets.line_field import FieldUse


class ExportScreen(Protocol):
    """What this key needs of a screen."""

    field: Any
    """Its LineField."""

    def say(self, text: str | None) -> None:
        """Show a note."""

    def ask(self, text: str | Callable[[], str], perform: Callable[[], None], *, word: str = "") -> None:
        """Ask before an action."""


class ChosenLog(msgspec.Struct, frozen=True):
    """What the key exports."""

    path: Path
    part: str = ""
    """Where the part begins and ends, as the field takes it; "" for the whole log."""


class FileExport:
    """Asks for the name, whose ending chooses the format, and starts the export into `folder`.

    `choose` returns the log, or why there is none. `take_number` numbers the export.
    """

    def __init__(
        self,
        screen: ExportScreen,
        choose: Callable[[], ChosenLog | str],
        folder: Path,
        exports: Exports,
        take_number: Callable[[], int],
    ) -> None:
        self._screen = screen
        self._choose = choose
        self._folder = folder
        self._exports = exports
        self._take_number = take_number
        self._started: set[int] = set()

    @property
    def progress(self) -> str | None:
        """How far the oldest export is; None: none runs."""
        running = [line for line in self._exports.lines if line.state == "running"]
        return f"{clean(running[0].what)} {percent_text(running[0])} · x stops it" if running else None

    def tell_end(self) -> None:
        """Say how an export has ended that this screen has started."""
        for line in self._exports.lines:
            if line.state != "running" and line.number in self._started:
                self._started.discard(line.number)
                self._screen.say(f"{clean(line.what)}: {line.state}{f', {clean(line.detail)}' if line.detail else ''}")

    def cancel(self) -> bool:
        """Stop the oldest export, which then writes nothing; return whether one runs."""
        return any(self._exports.cancel(line.number) for line in self._exports.lines[:1])

    def ask(self) -> None:
        """Ask for the name."""
        log = self._choose()
        if isinstance(log, str):
            self._screen.say(log)
            return
        use = FieldUse(lambda text: self._submit(log.path, text))
        self._screen.say(f"export into {short_path(self._folder)} as {NAMES}")
        name = log.path.name.removesuffix(LOG_SUFFIX)
        self._screen.field.open(use, text=f"{name}.mcap {log.part}".strip(), placeholder=NAMES)

    def _submit(self, log: Path, text: str) -> None:
        request = parse_request(text, log, self._folder)
        if request is None:
            self._screen.say(f"{clean(text.strip())!r}: name it {NAMES}" if text.strip() else None)
        elif request.output.exists():
            what = f"{clean(request.output.name)} is here already and would be replaced"
            self._screen.ask(what, lambda: self._start(request, overwrite=True), word="overwrite")
        else:
            self._start(request)

    def _start(self, request: ExportRequest, *, overwrite: bool = False) -> None:
        number = self._take_number()
        self._started.add(number)
        self._exports.start(number, request, overwrite=overwrite)
        self._screen.say(f"exporting {clean(request.output.name)} into {short_path(request.output.parent)}")
