"""FilesModel: what the Files screen lists, where its cursors are, and the requests that it makes. No widgets."""

from __future__ import annotations

from collections.abc import Callable
from enum import IntEnum
from pathlib import Path, PurePosixPath

from groundstation.intents.files import (
    CompareFile,
    EraseLogs,
    GetFile,
    GetLog,
    ListFolder,
    ListLogs,
    PutFile,
    RemoveFile,
)
from groundstation.intents.services import ServiceIntent
from groundstation.ui.base.local_files import LocalFile
from groundstation.ui.display.task_list import TaskList
from groundstation.ui.files.local_folder import LocalFolder
from groundstation.ui.files.tree import ROOT, TreeRow, build_tree
from groundstation.views.files import FilesRequest, FilesView, VehicleLog

MAX_OPEN = 32
"""Folders that are open at once."""
PART = ".part"
DOWNLOAD = "download "
"""With which the text of a task begins that writes a file here."""


class FilesPanel(IntEnum):
    """Panels, in the order of TAB."""

    LOGS = 0
    TREE = 1
    HERE = 2
    TASKS = 3


class FilesModel:
    """Lives as long as the app. `take_number` returns numbers for requests; `folder` is where downloads go."""

    def __init__(self, take_number: Callable[[], int], folder: Path) -> None:
        self._take_number = take_number
        self.disk = LocalFolder(folder)
        self.view: FilesView | None = None
        self.tasks = TaskList()
        self.chosen = FilesPanel.LOGS
        self._cursors = dict.fromkeys(FilesPanel, 0)
        self._open: list[str] = [ROOT]
        self._system: int | None = None
        self._refresh: dict[int, str] = {}
        """Request -> folder to list when it has ended."""

    # ---- lists ----

    @property
    def request(self) -> FilesRequest:
        """The request for the view."""
        return FilesRequest(tuple(self._open))

    def show_view(self, view: FilesView) -> list[ServiceIntent]:
        """Show a view; return what to request of a vehicle that is shown for the first time."""
        self.view = view
        if view.system == self._system:
            return []
        self._system, self._open = view.system, [ROOT]
        return self.read_again()

    def read_again(self) -> list[ServiceIntent]:
        """Return the requests to list the logs and all open folders."""
        lists = [ListFolder(request=self._take_number(), system=self._at, path=path) for path in self._open]
        return [ListLogs(request=self._take_number(), system=self._at), *lists]

    def finish(self) -> list[ServiceIntent]:
        """Return what to list anew because a request has ended; look which files are here now."""
        ended = self.tasks.pop_ended()
        if ended:
            self.disk.scan()
            self.disk.take_ended(line for line in self.tasks.ended if line.number in ended)
        folders = {self._refresh.pop(number) for number in ended if number in self._refresh}
        return [ListFolder(request=self._take_number(), system=self._at, path=path) for path in sorted(folders)]

    @property
    def here(self) -> tuple[LocalFile, ...]:
        """The files of this machine, the newest first."""
        return self.disk.files

    def mark_here(self, name: str) -> None:
        """Put the cursor on a file of this machine."""
        self.disk.scan()
        self.chosen = FilesPanel.HERE
        names = [each.name for each in self.here]
        self._cursors[FilesPanel.HERE] = names.index(name) if name in names else 0

    @property
    def vehicle(self) -> str:
        """Name of the vehicle."""
        return self.view.name if self.view is not None else "the vehicle"

    @property
    def logs(self) -> tuple[VehicleLog, ...]:
        """Logs of the vehicle, the newest first."""
        logs = self.view.logs if self.view and self.view.logs else ()
        return tuple(sorted(logs, key=lambda log: (-log.begun, -log.number)))

    @property
    def tree(self) -> tuple[TreeRow, ...]:
        """The lines of the tree: each open folder with what is in it."""
        return build_tree(self.view.folders if self.view else (), self._open)

    def log_name(self, number: int) -> str:
        """Return the name of a log here, as `mavhelm log get` gives it."""
        return f"{self._at}-{number:05}{self.view.log_ending if self.view is not None else '.bin'}"

    def is_arriving(self, name: str) -> bool:
        """Return whether a file here, or the beginning of one, is being downloaded."""
        arriving = {line.what.removeprefix(DOWNLOAD) for line in self.tasks.running if line.what.startswith(DOWNLOAD)}
        logs = {self.log_name(log.number) for log in self.logs if f"log {log.number}" in arriving}
        return name.removesuffix(PART) in logs | {PurePosixPath(each).name for each in arriving}

    # ---- cursors ----

    def count(self, panel: FilesPanel) -> int:
        """Return how many rows a panel has."""
        return (len(self.logs), len(self.tree), len(self.here), len(self.tasks.lines))[panel]

    def cursor(self, panel: FilesPanel) -> int:
        """Return the row of the cursor in a panel."""
        return max(0, min(self._cursors[panel], self.count(panel) - 1))

    def shown_cursor(self, panel: FilesPanel) -> int | None:
        """Return the row to mark: in the chosen panel only, and where there is a row."""
        return self.cursor(panel) if panel is self.chosen and self.count(panel) else None

    def move(self, rows: int) -> None:
        """Move the cursor of the chosen panel."""
        self._cursors[self.chosen] = max(0, min(self.cursor(self.chosen) + rows, self.count(self.chosen) - 1))

    def choose_panel(self, step: int) -> None:
        """Choose the next panel, or the one before."""
        self.chosen = FilesPanel((self.chosen + step) % len(FilesPanel))

    @property
    def log(self) -> VehicleLog | None:
        """The log under the cursor."""
        return self.logs[self.cursor(FilesPanel.LOGS)] if self.chosen is FilesPanel.LOGS and self.logs else None

    @property
    def node(self) -> TreeRow | None:
        """The line of the tree under the cursor."""
        return self.tree[self.cursor(FilesPanel.TREE)] if self.chosen is FilesPanel.TREE else None

    @property
    def local(self) -> LocalFile | None:
        """The file of this machine under its cursor, in whichever panel the arrows are."""
        return self.here[self.cursor(FilesPanel.HERE)] if self.here else None

    @property
    def target_folder(self) -> str:
        """Folder of the vehicle into which an upload goes: that of the cursor in the tree."""
        node = self.tree[self.cursor(FilesPanel.TREE)]
        return node.path if node.size is None else str(PurePosixPath(node.path).parent)

    # ---- requests ----

    def toggle(self) -> list[ServiceIntent]:
        """Open the folder under the cursor, or close it."""
        node = self.node
        if node is None or node.size is not None:
            return []
        if node.path in self._open and not node.problem:
            self._open = [each for each in self._open if each != node.path and not each.startswith(f"{node.path}/")]
            return []
        self._open = [*(each for each in self._open if each != node.path), node.path][-MAX_OPEN:]
        return [ListFolder(request=self._take_number(), system=self._at, path=node.path)]

    def download(self, *, overwrite: bool = False) -> ServiceIntent | None:
        """Return the request for the log or file under the cursor."""
        folder = str(self.disk.folder)
        if self.log is not None:
            return GetLog(
                request=self._take_number(),
                system=self._at,
                log=self.log.number,
                folder=folder,
                name=self.log_name(self.log.number),
                overwrite=overwrite,
            )
        node = self.node
        if node is None or node.size is None:
            return None
        return GetFile(
            request=self._take_number(),
            system=self._at,
            path=node.path,
            folder=folder,
            name=node.name,
            overwrite=overwrite,
        )

    @property
    def download_name(self) -> str:
        """Name here of what is under the cursor; "" if that is not a file."""
        if self.log is not None:
            return self.log_name(self.log.number)
        return self.node.name if self.node is not None and self.node.size is not None else ""

    def upload(self, file: Path) -> ServiceIntent:
        """Return the request to upload a file into the target folder."""
        path = f"{self.target_folder.rstrip(ROOT)}/{file.name}"
        return self._then_list(
            PutFile(request=self._take_number(), system=self._at, path=path, file=str(file)), self.target_folder
        )

    def remove(self, path: str) -> ServiceIntent:
        """Return the request to remove a file of the vehicle."""
        parent = str(PurePosixPath(path).parent)
        return self._then_list(RemoveFile(request=self._take_number(), system=self._at, path=path), parent)

    def compare(self) -> ServiceIntent | None:
        """Return the request to compare the file of the tree's cursor with that of its name here, or the marked one."""
        node = self.tree[self.cursor(FilesPanel.TREE)]
        local = self.disk.find(node.name) or self.local
        if node.size is None or local is None:
            return None
        request = self._take_number()
        self.disk.compare(request, local)
        return CompareFile(request=request, system=self._at, path=node.path, file=str(self.disk.folder / local.name))

    def erase(self) -> ServiceIntent:
        """Return the request to erase all logs."""
        return EraseLogs(request=self._take_number(), system=self._at)

    @property
    def _at(self) -> int:
        return self._system or 0

    def _then_list(self, intent: ServiceIntent, folder: str) -> ServiceIntent:
        self._refresh[intent.request] = folder
        return intent
