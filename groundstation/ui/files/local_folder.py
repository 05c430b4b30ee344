"""LocalFolder: the files of a folder of this machine, what is in the logs, and how comparisons with a vehicle ended."""

from __future__ import annotations

import asyncio
from collections.abc import Iterable
from pathlib import Path

from groundstation.snapshot import RecordingView
from groundstation.ui.base.local_files import LocalFile, list_files
from groundstation.ui.files.log_summary import LogSummary, read_summary
from groundstation.views.requests import RequestLine

SUMMARIZED = ".tlog"
"""Ending of the logs whose summary is read."""
ACCEPTED = "accepted"


class LocalFolder:
    """Lives as long as the app. A file that has changed is another one: what was known of it is forgotten."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.files: tuple[LocalFile, ...] = ()
        self.recording: RecordingView | None = None
        self.summaries: dict[LocalFile, LogSummary | None] = {}
        self._compared: dict[LocalFile, str] = {}
        self._comparing: dict[int, LocalFile] = {}
        """Request -> the file that is compared."""

    def scan(self) -> None:
        """Look which files are here."""
        self.files = list_files(self.folder)
        here = set(self.files)
        self.summaries = {file: found for file, found in self.summaries.items() if file in here}
        self._compared = {file: found for file, found in self._compared.items() if file in here}

    def show_recording(self, recording: RecordingView | None) -> None:
        """Show the recording of this session; look for its file when another one begins."""
        before, self.recording = self.recording, recording
        if recording is not None and (before is None or before.path != recording.path):
            self.scan()

    def is_recorded(self, file: LocalFile) -> bool:
        """Return whether this session is recorded into the file."""
        return self.recording is not None and Path(self.recording.path) == self.folder / file.name

    def find(self, name: str) -> LocalFile | None:
        """Return a file of the folder."""
        return next((each for each in self.files if each.name == name), None)

    @property
    def unread(self) -> list[LocalFile]:
        """Logs whose summary is not known yet."""
        return [file for file in self.files if file.name.endswith(SUMMARIZED) and file not in self.summaries]

    async def read_summaries(self) -> None:
        """Read the summaries that are not known yet, each in a thread: a card may be slow."""
        while self.unread:
            for file in self.unread:
                self.summaries[file] = await asyncio.to_thread(read_summary, self.folder / file.name)

    async def remove(self, name: str) -> str | None:
        """Remove a file; return why that cannot be done."""
        try:
            await asyncio.to_thread((self.folder / name).unlink)
        except OSError as error:
            return error.strerror or str(error)
        self.scan()
        return None

    def compare(self, request: int, file: LocalFile) -> None:
        """Remember which file a request compares."""
        self._comparing[request] = file

    def take_ended(self, lines: Iterable[RequestLine]) -> None:
        """Handle the requests that have ended."""
        for line in lines:
            file = self._comparing.pop(line.number, None)
            if file is not None and line.state == ACCEPTED:
                self._compared[file] = line.detail

    def comparison_of(self, file: LocalFile) -> str:
        """Return how the last comparison of a file ended; "" if it was not compared."""
        return self._compared.get(file, "")
