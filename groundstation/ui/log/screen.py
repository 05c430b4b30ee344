"""Log screen: all alerts that hold now, the messages of the session, and the detail of the marked one."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable
from functools import partial
from pathlib import Path

from msgspec.structs import replace
from textual import events
from textual.containers import Container
from textual.widget import Widget

from groundstation.intents.services import CancelRequest
from groundstation.ui.base.list_keys import rows_to_move
from groundstation.ui.base.local_files import short_path
from groundstation.ui.base.save_file import save_text
from groundstation.ui.base.screen import LIST_ARROWS, ConsoleScreen, ScreenContext
from groundstation.ui.display.alerts import active_alerts
from groundstation.ui.display.display_state import DisplayState, ScreenKey
from groundstation.ui.display.task_list import TaskList
from groundstation.ui.display.wrap import clean, plain
from groundstation.ui.files.tables import tasks_value
from groundstation.ui.log.detail import LogDetail, describe
from groundstation.ui.log.detail_panel import LogDetailPanel
from groundstation.ui.log.filter import LogFilter
from groundstation.ui.log.model import LogModel, LogWindow, format_lines
from groundstation.ui.log.panel import PREFIX, LogRows
from groundstation.ui.widgets.alert_list import AlertList, AlertListValue, alert_rows
from groundstation.ui.widgets.line_field import FieldUse
from groundstation.ui.widgets.row_table import RowTable
from groundstation.views.base import View, ViewRequest
from groundstation.views.log import LogPage
from groundstation.views.requests import RequestsRequest, RequestsView

LEAST_ROWS = 4
"""Rows of messages that the alerts leave, where there are many."""

BORDERS = 2

WIDE = 120
"""Columns from which on the detail is always shown, at the right of the messages."""

MOST_DETAIL = 12
"""Rows of the detail below the messages, with its frame."""

MAX_TASKS = 3
"""Tasks that are listed; the Files screen has them all."""

_SOURCES = {
    "v": (("vehicle", "state"), "of vehicles"),
    "h": (("station",), "of this ground station"),
    "m": (("you", "ack"), "your keys and the answers"),
}
"""Key -> labels of the lines that it shows, and what they are."""


class LogScreen(ConsoleScreen):
    """Alerts over messages. TAB chooses which of them have the arrows."""

    CSS_PATH = "screen.tcss"
    KEYS = (
        ScreenKey("slash", "Filter", "Show the messages that contain a text"),
        ScreenKey("a", "All", "Show all messages"),
        ScreenKey("w", "Warnings", "Show warnings and worse only"),
        ScreenKey("v", "Vehicle", "Show what vehicles sent and how they changed only"),
        ScreenKey("h", "Here", "Show the events of this ground station only"),
        ScreenKey("m", "Mine", "Show what your keys did, and the answers to your commands only"),
        ScreenKey(
            "enter", "Detail", "Show or hide the detail of the marked message; from 120 columns on it is always there"
        ),
        ScreenKey("e", "Around", "Show the messages within 5 s of the marked one only, or what was shown before"),
        ScreenKey("o", "Replay", "Replay this session from the marked message, until Ctrl-Q"),
        ScreenKey("S", "Save", "Save the messages that are shown to a file"),
        ScreenKey("y", "Copy", "Copy the text of the marked message"),
        ScreenKey("tab", "Alerts", "Scroll the alerts, or the messages again"),
        ScreenKey("x", "Stop task", "Stop the newest task that runs; what has arrived is kept"),
    )

    def __init__(self, context: ScreenContext) -> None:
        super().__init__(context)
        self._model = LogModel()
        self._alerts = AlertList(AlertListValue(), id="alerts")
        self._rows = LogRows(LogWindow(), id="rows")
        self._detail = LogDetailPanel(LogDetail(), id="detail")
        self._detail_open = False
        self._tasks = TaskList()
        self._task_rows = RowTable(tasks_value(self._tasks, None), id="tasks")
        self._scrolls_alerts = False

    # ---- what all screens define ----

    def compose_body(self) -> Iterable[Widget]:
        """Lay out the alerts over the messages with their detail, and below them the tasks while any run."""
        lines = self.build_panel(self._rows, "log"), self.build_panel(self._detail, "detail")
        tasks = self.build_panel(self._task_rows, "tasks")
        return self.build_panel(self._alerts, "alerts"), Container(*lines, id="lines"), tasks

    def on_mount(self) -> None:
        """Mark the panel that the arrows scroll."""
        self._mark_chosen()

    def requests(self) -> tuple[ViewRequest, ...]:
        """Return the requests for new lines and for the tasks."""
        return self._model.request, RequestsRequest()

    def show_view(self, view: View) -> None:
        """Add new lines."""
        if isinstance(view, LogPage):
            self._model.add(view)
            self._show_lines()
        elif isinstance(view, RequestsView):
            self._tasks.show(view, time.monotonic())
            self.show_body(self._state)

    def show_body(self, now: DisplayState) -> None:
        """Show the alerts, and the lines at their place."""
        alerts = tuple(active_alerts(now))
        self._alerts.show(AlertListValue(alerts, min(self._alerts.value.top, self._last_alert_row(len(alerts)))))
        wanted = max(1, len(alert_rows(alerts, self.room.width - BORDERS)))
        running = min(len(self._tasks.running), MAX_TASKS)
        self._task_rows.display = running > 0
        self._task_rows.styles.height = running + BORDERS
        self._task_rows.show(replace(tasks_value(self._tasks, None), notes=()))
        below = self._place_detail() + (running + BORDERS if running else 0)
        room = self.room.height - 4 - 2 * BORDERS - LEAST_ROWS - below
        self._alerts.styles.height = BORDERS + max(1, min(wanted, room))
        self._alerts.border_subtitle = plain(f"{wanted} rows · TAB, then ↑ ↓" if wanted > room else "")
        self._show_lines()

    def _place_detail(self) -> int:
        """Show the detail at its place; return the rows that it takes below the messages."""
        wide = self.room.width >= WIDE
        rows = 0 if wide or not self._detail_open else min(MOST_DETAIL, self.room.height - 5 - LEAST_ROWS - 2 * BORDERS)
        self.set_class(wide, "-wide")
        self._detail.display = wide or rows > BORDERS
        self._detail.styles.height = "1fr" if wide else max(1, rows)
        return rows if rows > BORDERS else 0

    def on_resize(self, event: events.Resize) -> None:
        """Lay out the alerts and wrap the lines for the new size."""
        self.show_body(self._state)

    @property
    def advice(self) -> str:
        """Return what the window shows."""
        chosen = self._model.filter
        if chosen.problem:
            return chosen.problem
        parts = ["live, newest below" if self._model.following else "END follows the newest line"]
        if chosen.moment is not None:
            return " · ".join(["within 5 s of one line", "e or ESC shows what was shown before"])
        parts += ["warnings and worse"] if chosen.warnings else []
        parts += [text for labels, text in _SOURCES.values() if labels == chosen.labels]
        parts += [f"with “{chosen.text}”"] if chosen.text else []
        return " · ".join([*parts, "ESC goes back to Drive"])

    # ---- keys ----

    def perform_key(self, event: events.Key) -> bool:
        """Handle the keys of this screen."""
        widget: Widget = self._alerts if self._scrolls_alerts else self._rows
        if rows := rows_to_move(event.key, widget.size.height):
            self._scroll(rows)
        elif event.key == "escape":
            return self._close()
        elif event.key in _ACTIONS:
            _ACTIONS[event.key](self)
        else:
            return False
        return True

    def _copy(self) -> None:
        if (line := self._model.marked) is not None:
            self.copy(clean(line.text))

    def choose_panel_of(self, widget: Widget) -> tuple[str, str] | None:
        """Give the arrows to the alerts or the messages."""
        if widget not in (self._alerts, self._rows):
            return None
        self._scrolls_alerts = widget is self._alerts
        self._mark_chosen()
        return LIST_ARROWS

    @property
    def kept_filter(self) -> str:
        """The text of the filter."""
        return self._model.filter.text

    def filter_by(self, text: str) -> bool:
        """Show the rows that the text describes."""
        self._filter_text(text)
        return True

    def _open_filter(self) -> None:
        use = FieldUse(self._filter_text, self._filter_text, cancel=lambda: self._filter_text(""))
        placeholder = "words, >=warning; ENTER keeps them, ESC shows all"
        self.field.open(use, text=self._model.filter.text, placeholder=placeholder, selected=True)

    def _filter_text(self, text: str) -> None:
        self._set_filter(replace(self._model.filter, text=text))

    def _show_warnings(self) -> None:
        self._set_filter(LogFilter(self._model.filter.text, warnings=True))

    def _show_labels(self, labels: tuple[str, ...]) -> None:
        self._set_filter(LogFilter(self._model.filter.text, labels=labels))

    def _show_all(self) -> None:
        self._set_filter(LogFilter())

    def _set_filter(self, chosen: LogFilter) -> None:
        self._model.set_filter(chosen)
        self._show_lines()

    def _toggle_detail(self) -> None:
        self._detail_open = not self._detail_open

    def _toggle_around(self) -> None:
        self._model.toggle_around()
        self._show_lines()

    def _close(self) -> bool:
        """Close what `e` or ENTER has opened, the last one first; return False where nothing is open."""
        if self._model.filter.moment is not None:
            self._toggle_around()
        elif self._detail_open and self.room.width < WIDE:
            self._toggle_detail()
        else:
            return False
        return True

    def _swap_scrolling(self) -> None:
        self._scrolls_alerts = not self._scrolls_alerts
        self._mark_chosen()

    def _stop_task(self) -> None:
        if self._tasks.running:
            self.context.send(CancelRequest(self._tasks.running[0].number))

    def _mark_chosen(self) -> None:
        self._alerts.set_class(self._scrolls_alerts, "-chosen")
        self._rows.set_class(not self._scrolls_alerts, "-chosen")

    def _scroll(self, rows: int) -> None:
        if not self._scrolls_alerts:
            self._model.move(rows)
            return
        value = self._alerts.value
        top = max(0, min(self._last_alert_row(len(value.alerts)), value.top + rows))
        self._alerts.show(AlertListValue(value.alerts, top))

    def _last_alert_row(self, count: int) -> int:
        rows = len(alert_rows(self._alerts.value.alerts, self._alerts.size.width)) if count else 0
        return max(0, rows - self._alerts.size.height)

    def _show_lines(self) -> None:
        """Show the window of the log at the size that the widget has now."""
        self._model.set_width(max(1, self._rows.size.width - PREFIX))
        self._rows.show(self._model.window(self._rows.size.height))
        detail = describe(self._model.marked, self._model.group)
        self._detail.show(detail)
        self._detail.border_title = plain(detail.title)
        shown, count = len(self._model.shown), self._model.count
        self._rows.border_subtitle = plain(f"{count} lines" if shown == count else f"{shown} of {count} lines")

    # ---- files ----

    def _replay(self) -> None:
        """Show the recording of this session at the time of the marked line."""
        recording, line = self._state.snapshot.recording, self._model.marked
        if recording is None or not recording.path:
            self.say("this session is not recorded")
        else:
            at = time.strftime("%H:%M:%S", time.localtime(line.time)) if line else ""
            self.open_log(Path(recording.path), at)

    def _save(self) -> None:
        lines = self._model.shown
        path = self.context.folder / time.strftime("messages-%Y%m%d-%H%M%S.txt")
        problem = save_text(path, format_lines(lines))
        self.say(
            f"not saved: {problem}: {short_path(path)}"
            if problem
            else f"saved {len(lines)} lines to {short_path(path)}"
        )


_ACTIONS: dict[str, Callable[[LogScreen], None]] = {
    "slash": LogScreen._open_filter,
    "y": LogScreen._copy,
    "a": LogScreen._show_all,
    "w": LogScreen._show_warnings,
    **{key: partial(LogScreen._show_labels, labels=labels) for key, (labels, _) in _SOURCES.items()},
    "enter": LogScreen._toggle_detail,
    "e": LogScreen._toggle_around,
    "o": LogScreen._replay,
    "S": LogScreen._save,
    "tab": LogScreen._swap_scrolling,
    "x": LogScreen._stop_task,
}
"""Key -> what it does; LogScreen.KEYS has their names."""
