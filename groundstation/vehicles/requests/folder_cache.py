"""FolderCache: the folders of one vehicle that were listed, for a screen."""

from __future__ import annotations

import msgspec

from groundstation.vehicles.requests.file_requests import FileRequests
from groundstation.vehicles.requests.requests import RequestReport
from link.services.ftp.files import DirectoryEntry

MAX_FOLDERS = 64
"""Folders that are kept; the oldest goes first."""

MAX_ENTRIES = 1000
"""Entries of a folder that are kept."""


class ListedFolder(msgspec.Struct, frozen=True):
    """One folder."""

    entries: tuple[DirectoryEntry, ...] = ()
    """Folders first, by name."""
    problem: str = ""
    """Why it could not be listed."""


class FolderCache:
    """Lists folders and keeps the newest list of each."""

    def __init__(self, files: FileRequests) -> None:
        self._files = files
        self._asked: dict[int, str] = {}
        self.folders: dict[str, ListedFolder] = {}

    def list_folder(self, number: int, path: str, now: float) -> None:
        """List a folder."""
        self._asked[number] = path
        self._files.list_folder(number, path, now)

    def cancel(self, number: int, now: float) -> None:
        """End nothing: the report of the cancelled request follows."""

    def handle_report(self, report: RequestReport, now: float) -> None:
        """Store the list of a request that has ended."""
        if not report.state.ended or report.number not in self._asked:
            return
        path = self._asked.pop(report.number)
        outcome = self._files.pop_result(report.number)
        if outcome is not None and outcome.done:
            entries = sorted(outcome.entries, key=lambda entry: (entry.size is not None, entry.name))
            found = ListedFolder(tuple(entries[:MAX_ENTRIES]))
        else:
            found = ListedFolder(problem=report.detail or report.state.value)
        self.folders.pop(path, None)
        self.folders[path] = found
        if len(self.folders) > MAX_FOLDERS:
            del self.folders[next(iter(self.folders))]
