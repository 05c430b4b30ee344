"""Files screen: logs and files of the vehicle, files here, and the transfers that run."""

from __future__ import annotations

import time
from collections.abc import Iterable, Sequence
from pathlib import Path

from textual import events
from textual.containers import Horizontal
from textual.widget import Widget
from textual.worker import Worker

from groundstation.intents.services import CancelRequest, ServiceIntent
from groundstation.ui.base.list_keys import rows_to_move
from groundstation.ui.base.local_files import short_path
from groundstation.ui.base.screen import LIST_ARROWS, ConsoleScreen, ScreenContext
from groundstation.ui.display.display_state import DisplayState, ScreenKey
from groundstation.ui.display.wrap import clean, plain
from groundstation.ui.files.export import ChosenLog, FileExport
from groundstation.ui.files.exports import LOG_SUFFIX, Exports
from groundstation.ui.files.model import FilesModel, FilesPanel
from groundstation.ui.files.removal import FileRemoval
from groundstation.ui.files.tables import (
    here_value,
    logs_value,
    percent_text,
    progress_text,
    size_text,
    tasks_value,
    tree_value,
)
from groundstation.ui.terminal.key_parser import KeyRepeat
from groundstation.ui.widgets.line_field import FieldUse
from groundstation.ui.widgets.row_table import RowTable
from groundstation.views.base import View, ViewRequest
from groundstation.views.files import FilesView
from groundstation.views.requests import RequestsRequest, RequestsView


class FilesScreen(ConsoleScreen):
    """Four panels; where the terminal is narrow, one page of the first three over the tasks. TAB chooses."""

    CSS_PATH = "screen.tcss"
    HORIZONTAL_BREAKPOINTS = [(0, "-narrow"), (120, "-wide")]  # noqa: RUF012 - Textual declares it so
    KEYS = (
        ScreenKey("D", "Download", "Download the log or file under the cursor; one that was interrupted goes on"),
        ScreenKey("tab", "Panel", "Next panel: logs there, files there, files here, tasks"),
        ScreenKey("enter", "Open", "Open or close the folder under the cursor"),
        ScreenKey("x", "Stop task", "Stop the task under the cursor, else the newest; what has arrived is kept"),
        ScreenKey("U", "Upload", "Upload a file of this machine into the folder under the cursor", commands=True),
        ScreenKey("C", "Compare", "Compare the file under the cursor there with that here, by their checksums"),
        ScreenKey(
            "X",
            "Delete",
            "Delete the file under the cursor, there or here; all logs of the vehicle; after a word",
            commands=True,
        ),
        ScreenKey(
            "E", "Export", "Export the log under the cursor here, or a part of it; the ending chooses the format"
        ),
        ScreenKey("o", "Replay", "Show the telemetry log under the cursor here in all screens, until Ctrl-Q"),
        ScreenKey("R", "Read", "List the logs and the open folders again"),
    )

    def __init__(self, context: ScreenContext) -> None:
        super().__init__(context)
        self._model = context.keep(FilesModel, context.numbers.take, context.folder)
        self._model.disk.scan()
        self._reading: Worker[None] | None = None
        self._exports = context.keep(Exports, context.dialect)
        self._export = FileExport(self, self._chosen_log, context.folder, self._exports, context.numbers.take)
        self._removal = FileRemoval(self, self._model)
        self._logs = RowTable(logs_value(self._model), id="logs")
        self._tree = RowTable(tree_value(self._model), id="tree")
        self._here = RowTable(here_value(self._model), id="here")
        self._tasks = RowTable(tasks_value(self._model.tasks, None), id="tasks")
        self._there = Horizontal(self._logs, self._tree, id="there")

    # ---- what all screens define ----

    def compose_body(self) -> Iterable[Widget]:
        """Lay out what is on the vehicle over what is here."""
        titles = ("logs on the vehicle", "files there", "files here", "tasks")
        for panel, title in zip(self._tables, titles, strict=True):
            self.build_panel(panel, title)
        return self._there, self._here, self._tasks

    def requests(self) -> tuple[ViewRequest, ...]:
        """Return the requests for the lists and the tasks."""
        return self._model.request, RequestsRequest()

    def show_view(self, view: View) -> None:
        """Show a view; list what is not known yet, or may have changed."""
        match view:
            case FilesView():
                self._send(self._model.show_view(view))
            case RequestsView():
                self._model.tasks.show(view, time.monotonic())
        self._show()

    def show_body(self, now: DisplayState) -> None:
        """Show the model."""
        self._model.disk.show_recording(now.snapshot.recording)
        self._show()

    @property
    def advice(self) -> str:
        """Return how the newest task stands, or what to do."""
        running = self._model.tasks.running
        if running:
            line = running[0]
            how = line.waits or f"{percent_text(line)} {progress_text(line, self._model.tasks)}".strip()
            return f"{line.what}: {how} · it goes on when you leave this screen · x stops it"
        return "D downloads · nothing is deleted before a word is typed · ESC goes back to Drive"

    # ---- keys ----

    def choose_panel_of(self, widget: Widget) -> tuple[str, str] | None:
        """Give the arrows to the list of a widget."""
        if widget not in self._tables:
            return None
        self._model.chosen = FilesPanel(self._tables.index(widget))
        self._show()
        return LIST_ARROWS

    def perform_key(self, event: events.Key) -> bool:
        """Handle the keys of this screen."""
        if rows := rows_to_move(event.key, self._tables[self._model.chosen].size.height):
            self._model.move(rows)
        elif event.key not in _ACTIONS:
            return False
        elif not isinstance(event, KeyRepeat):
            _ACTIONS[event.key](self)
        self._show()
        return True

    @property
    def marked_text(self) -> str:
        """The path of the file under the cursor, or what the task is."""
        model = self._model
        if model.chosen is FilesPanel.HERE:
            return str(model.disk.folder / model.local.name) if model.local is not None else ""
        if model.chosen is FilesPanel.TASKS:
            lines = model.tasks.lines
            return lines[model.cursor(FilesPanel.TASKS)].what if lines else ""
        return model.download_name if model.node is None else model.node.path

    def _toggle(self) -> None:
        self._send(self._model.toggle())

    def _download(self) -> None:
        name = self._model.download_name
        if not name:
            self.say("choose a log or a file of the vehicle first")
        elif self._model.disk.find(name) is None:
            self._send_one(self._model.download())
        else:
            wanted = self._model.download(overwrite=True)
            text = f"{clean(name)} is here already and would be replaced"
            self.ask(text, lambda: self._send_one(wanted), word="overwrite")

    def _upload(self) -> None:
        local = self._model.local
        text = str(self._model.disk.folder / local.name) if local is not None else ""
        place = f"file of this machine, to upload into {self._model.target_folder}"
        self.field.open(FieldUse(self._ask_upload), text=text, placeholder=place)

    def _ask_upload(self, text: str) -> None:
        file = Path(text.strip()).expanduser()
        if not text.strip() or not file.is_file():
            self.say(f"{text.strip()!r} is not a file of this machine" if text.strip() else None)
            return
        what = f"upload {file.name}, {size_text(file.stat().st_size)}, into {clean(self._model.target_folder)}"
        self.ask(f"{what} of {self._model.vehicle}", lambda: self._send_one(self._model.upload(file)))

    def _compare(self) -> None:
        wanted = self._model.compare()
        self._send_one(wanted)
        if wanted is None:
            self.say("choose a file of the vehicle first, in the files there, and a file here to compare it with")

    def _cancel(self) -> None:
        tasks = self._model.tasks
        at = self._model.cursor(FilesPanel.TASKS) if self._model.chosen is FilesPanel.TASKS else 0
        if at < len(tasks.running) and not self._exports.cancel(tasks.running[at].number):
            self.context.send(CancelRequest(tasks.running[at].number))

    def _replay(self) -> None:
        local = self._model.local if self._model.chosen is FilesPanel.HERE else None
        self.open_log(self._model.disk.folder / local.name if local is not None else None)

    def _chosen_log(self) -> ChosenLog | str:
        local = self._model.local
        if local is None or not local.name.endswith(LOG_SUFFIX):
            return f"choose a log in the files here first, a name in {LOG_SUFFIX}"
        return ChosenLog(self._model.disk.folder / local.name)

    def _read_again(self) -> None:
        if self._model.view is not None:
            self._send(self._model.read_again())
        self._model.disk.scan()

    def _next_panel(self) -> None:
        self._model.choose_panel(1)

    def _panel_before(self) -> None:
        self._model.choose_panel(-1)

    def _send(self, intents: Sequence[ServiceIntent]) -> None:
        for intent in intents:
            self.context.send(intent)

    def _send_one(self, intent: ServiceIntent | None) -> None:
        if intent is not None:
            self.context.send(intent)

    # ---- drawing ----

    @property
    def _tables(self) -> tuple[RowTable, ...]:
        return self._logs, self._tree, self._here, self._tasks

    def _show(self) -> None:
        model = self._model
        model.tasks.show_local(self._exports.lines, time.monotonic())
        self._send(model.finish())
        if model.disk.unread and (self._reading is None or self._reading.is_finished):
            self._reading = self.run_worker(model.disk.read_summaries())
        self._logs.show(logs_value(model))
        self._tree.show(tree_value(model))
        self._here.show(here_value(model))
        self._tasks.show(tasks_value(model.tasks, model.shown_cursor(FilesPanel.TASKS)))
        self._logs.border_subtitle = plain(_sum([log.size for log in model.logs]))
        self._tree.border_subtitle = "MAVLink FTP"
        self._here.border_subtitle = plain(
            f"{short_path(model.disk.folder)} · {_sum([each.size for each in model.here])}"
        )
        self._tasks.border_subtitle = plain(f"{len(model.tasks.running)} running · x stops one")
        page = FilesPanel.LOGS if model.chosen is FilesPanel.TASKS else model.chosen
        for panel, table in zip(FilesPanel, self._tables, strict=True):
            table.set_class(panel is model.chosen, "-chosen")
            table.set_class(panel not in (page, FilesPanel.TASKS), "-other-page")
        self._there.set_class(page is FilesPanel.HERE, "-other-page")


def _sum(sizes: Sequence[int]) -> str:
    return f"{len(sizes)} · {size_text(sum(sizes))}" if sizes else ""


_ACTIONS = {
    "enter": FilesScreen._toggle,
    "tab": FilesScreen._next_panel,
    "shift+tab": FilesScreen._panel_before,
    "D": FilesScreen._download,
    "U": FilesScreen._upload,
    "X": lambda screen: screen._removal.ask(),
    "C": FilesScreen._compare,
    "E": lambda screen: screen._export.ask(),
    "x": FilesScreen._cancel,
    "o": FilesScreen._replay,
    "R": FilesScreen._read_again,
}
"""Key -> what it does; FilesScreen.KEYS has their names."""
