"""Log screen: all alerts that hold now, and the messages of the session: scroll, filter, save."""

from __future__ import annotations

import time
from collections.abc import Iterable
from pathlib import Path

from textual import events
from textual.widget import Widget
from textual.widgets import Input

from groundstation.ui.alerts import active_alerts
from groundstation.ui.display_state import DisplayState, ScreenKey
from groundstation.ui.log_model import LogFilter, LogModel, format_lines
from groundstation.ui.screens.screen import ConsoleScreen, ScreenContext
from groundstation.ui.widgets.alert_list import AlertList, AlertListValue, alert_rows
from groundstation.ui.widgets.log import PREFIX, LogRows
from groundstation.views.base import View, ViewRequest
from groundstation.views.log import LogPage

LEAST_ROWS = 4
"""Rows of messages that the alerts leave, where there are many."""

BORDERS = 2

NOTE_TIME = 10.0
"""s for which the result of a save is shown."""

STEPS = {"up": -1, "down": 1, "pageup": -1, "pagedown": 1, "home": -1, "end": 1}
"""Key -> direction in which it scrolls."""


class LogScreen(ConsoleScreen):
    """Alerts over messages. TAB chooses which of them the arrows scroll."""

    CSS_PATH = "log.tcss"
    KEYS = (
        ScreenKey("slash", "Filter", "Show the messages that contain a text"),
        ScreenKey("w", "Warnings", "Show warnings and worse only"),
        ScreenKey("a", "All", "Show all messages"),
        ScreenKey("S", "Save", "Save the messages that are shown to a file"),
        ScreenKey("tab", "Alerts", "Scroll the alerts, or the messages again"),
    )

    def __init__(self, context: ScreenContext) -> None:
        super().__init__(context)
        self._model = LogModel()
        self._alerts = AlertList(AlertListValue(), id="alerts")
        self._rows = LogRows((), id="rows")
        self._field = Input(id="filter", placeholder="text; ENTER keeps it, ESC shows all")
        self._scrolls_alerts = False
        self._note, self._note_until = "", 0.0

    # ---- what all screens define ----

    def compose_body(self) -> Iterable[Widget]:
        """Lay out the alerts, the messages and the text of the filter, which is hidden until it is asked for."""
        self._alerts.border_title = "alerts"
        self._rows.border_title = "log"
        return self._alerts, self._rows, self._field

    def requests(self) -> tuple[ViewRequest, ...]:
        """Return the request for new lines."""
        return (self._model.request,)

    def show_view(self, view: View) -> None:
        """Add new lines."""
        if isinstance(view, LogPage):
            self._model.add(view)
            self._show_lines()

    def show_body(self, now: DisplayState) -> None:
        """Show the alerts, and the lines at their place."""
        alerts = tuple(active_alerts(now))
        self._alerts.show(AlertListValue(alerts, min(self._alerts.value.top, self._last_alert_row(len(alerts)))))
        wanted = max(1, len(alert_rows(alerts, self.size.width - BORDERS)))
        room = self.size.height - 4 - 2 * BORDERS - LEAST_ROWS
        self._alerts.styles.height = BORDERS + max(1, min(wanted, room))
        self._alerts.border_subtitle = f"{wanted} rows · TAB, then ↑ ↓" if wanted > room else ""
        self._show_lines()

    def on_resize(self, event: events.Resize) -> None:
        """Lay out the alerts and wrap the lines for the new size."""
        self.show_body(self._state)

    @property
    def hint(self) -> str:
        """Return the result of a save for some seconds, else what the window shows."""
        if time.monotonic() < self._note_until:
            return self._note
        chosen = self._model.filter
        parts = ["live, newest below" if self._model.following else "scrolled: END follows the newest line"]
        parts += ["warnings and worse"] if chosen.warnings else []
        parts += [f"with “{chosen.text}”"] if chosen.text else []
        return " · ".join([*parts, "ESC goes back to Drive"])

    @property
    def takes_text(self) -> bool:
        """Return whether the text of the filter is edited."""
        return self._field.has_focus

    # ---- keys ----

    def on_key(self, event: events.Key) -> None:
        """Handle the keys of this screen; those of other screens go on to the app."""
        if self.takes_text:
            if event.key == "escape":
                event.stop()
                self._end_text("")
            return
        if event.key in STEPS:
            event.stop()
            self._scroll(event.key)
        elif event.key in _ACTIONS:
            event.stop()
            _ACTIONS[event.key](self)
        self.show_state(self._state)

    def on_input_changed(self, event: Input.Changed) -> None:
        """Filter while the text is typed."""
        self._set_filter(LogFilter(event.value, self._model.filter.warnings))

    def on_input_submitted(self, event: Input.Submitted) -> None:
        """Keep the text."""
        self._end_text(event.value)

    def _begin_text(self) -> None:
        self._field.display = True
        self._field.focus()

    def _end_text(self, text: str) -> None:
        self._field.value = text
        self._field.display = bool(text)
        self.set_focus(None)
        self._set_filter(LogFilter(text, self._model.filter.warnings))

    def _show_warnings(self) -> None:
        self._set_filter(LogFilter(self._model.filter.text, warnings=True))

    def _show_all(self) -> None:
        self._end_text("")
        self._set_filter(LogFilter())

    def _set_filter(self, chosen: LogFilter) -> None:
        self._model.set_filter(chosen)
        self._show_lines()

    def _swap_scrolling(self) -> None:
        self._scrolls_alerts = not self._scrolls_alerts
        self.set_class(self._scrolls_alerts, "-alerts")

    def _scroll(self, key: str) -> None:
        widget: Widget = self._alerts if self._scrolls_alerts else self._rows
        height = max(1, widget.size.height)
        rows = STEPS[key] * {"up": 1, "down": 1, "home": 10**6, "end": 10**6}.get(key, max(1, height - 1))
        if not self._scrolls_alerts:
            self._model.scroll(rows, height)
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
        shown, count = len(self._model.shown), self._model.count
        self._rows.border_subtitle = f"{count} lines" if shown == count else f"{shown} of {count} lines"

    # ---- saving ----

    def _save(self) -> None:
        lines = self._model.shown
        path = self.context.folder / time.strftime("messages-%Y%m%d-%H%M%S.txt")
        try:
            path.write_text(format_lines(lines), "utf-8")
            self._note = f"saved {len(lines)} lines to {short_path(path)}"
        except OSError as error:
            self._note = f"not saved: {error.strerror}: {short_path(path)}"
        self._note_until = time.monotonic() + NOTE_TIME


_ACTIONS = {
    "slash": LogScreen._begin_text,
    "w": LogScreen._show_warnings,
    "a": LogScreen._show_all,
    "S": LogScreen._save,
    "tab": LogScreen._swap_scrolling,
}
"""Key -> what it does; LogScreen.KEYS has their names."""


def short_path(path: Path) -> str:
    """Return a path with "~" in place of the home folder."""
    home = Path.home()
    return f"~/{path.relative_to(home)}" if path.is_relative_to(home) else str(path)
