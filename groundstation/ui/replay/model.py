"""ReplayModel: the newest view of a replay, the chosen event, and texts for the screen. Knows no widget."""

from __future__ import annotations

import time

from groundstation.ui.files.tables import size_text
from groundstation.views.replay import ReplayEvent, ReplayRequest, ReplayView


class ReplayModel:
    """What the Replay screen shows."""

    def __init__(self) -> None:
        self.view: ReplayView | None = None
        self.cursor: int | None = None
        """Number of the chosen event; None: the present one."""
        self.search = ""
        """The newest search."""
        self._notes = 0

    def request(self, columns: int, rows: int) -> ReplayRequest:
        """Return the request for a timeline and a list of these sizes."""
        top = None if self.cursor is None else max(0, self.cursor - rows // 2)
        return ReplayRequest(max(1, columns), max(1, rows), top)

    def show_view(self, view: ReplayView) -> str | None:
        """Show a view; return a note that is new."""
        new = view.note if view.notes != self._notes else None
        self.view, self._notes = view, view.notes
        return new

    def move_cursor(self, rows: int) -> None:
        """Choose another event."""
        if self.view is not None and self.view.total:
            start = self.view.current if self.cursor is None else self.cursor
            self.cursor = max(0, min(self.view.total - 1, start + rows))

    @property
    def chosen(self) -> int | None:
        """Number of the event under the cursor, or of the present one."""
        if self.view is None:
            return None
        return self.view.current if self.cursor is None else self.cursor

    @property
    def marked(self) -> ReplayEvent | None:
        """That event, if it is among those of the view."""
        view, chosen = self.view, self.chosen
        at = -1 if view is None or chosen is None else chosen - view.top
        return view.events[at] if view is not None and 0 <= at < len(view.events) else None

    @property
    def advice(self) -> str:
        """Return what stands at this moment."""
        view = self.view
        if view is None:
            return "reading the log"
        if view.searching:
            return f"searching {view.searching} · ESC ends it"
        if view.indexed < 1:
            return f"index {100 * view.indexed:.0f} %: later parts follow"
        event, number = self.marked, self.chosen
        if self.cursor is None or event is None:
            event, number = view.current_event, view.current
        if event is None or number is None:
            return "p plays · ← → move · n goes to the first event · / searches"
        return f"event {number + 1} of {view.total}: {event.text}"


def summary(view: ReplayView) -> str:
    """Return the file, its times and its size in one line."""
    began, ended = time.localtime(view.began), time.localtime(view.ended)
    day = time.strftime("%Y-%m-%d", began)
    times = f"{time.strftime('%H:%M:%S', began)} – {time.strftime('%H:%M:%S', ended)}"
    count = f"{view.messages:,}".replace(",", " ")
    return f"{day} {view.file} · {times} · {duration_text(view.duration)} · {count} messages · {size_text(view.size)}"


def short_summary(view: ReplayView) -> str:
    """Return the file and its length."""
    count = f"{view.messages:,}".replace(",", " ")
    return f"{view.file} · {duration_text(view.duration)} · {count} messages"


def part_text(view: ReplayView) -> str:
    """Return the marks as `mavhelm export` takes them: "0:31.5 0:44"; "" without marks."""
    return " ".join(_offset_text(each) for each in view.cut if each is not None)


def _offset_text(seconds: float) -> str:
    whole, microseconds = divmod(round(max(0.0, seconds) * 1e6), 1_000_000)
    fraction = f".{microseconds:06}".rstrip("0") if microseconds else ""
    return f"{whole // 60}:{whole % 60:02}{fraction}"


def quality(view: ReplayView) -> tuple[str, bool]:
    """Return what is damaged, lost or not read yet, and whether it is bad."""
    parts = []
    if view.indexed < 1:
        parts.append(f"index {100 * view.indexed:.0f} %")
    elif view.checked < 1:
        parts.append(f"checksums {100 * view.checked:.0f} %")
    if view.damaged:
        parts.append(f"{view.damaged} bytes left out")
    if view.tail:
        parts.append(f"{view.tail} bytes cut off at the end")
    if view.lost:
        parts.append(f"{view.lost} packets lost on the link")
    return " · ".join(parts) or "no damage, nothing lost", bool(view.damaged or view.tail)


def directions(view: ReplayView) -> str:
    """Return whose messages the log has."""
    vehicles = ", ".join(map(str, view.vehicles)) or "none"
    stations = ", ".join(map(str, view.stations))
    return f"vehicle {vehicles} · {f'ground station {stations}' if stations else 'only what vehicles sent'}"


def duration_text(seconds: float, *, tenths: bool = False) -> str:
    """Return a time as 0:35, 12:04 or 1:02:03, with tenths where wanted."""
    whole = int(seconds)
    hours, minutes, rest = whole // 3600, whole // 60 % 60, whole % 60
    text = f"{hours}:{minutes:02}:{rest:02}" if hours else f"{minutes}:{rest:02}"
    return f"{text}.{int(seconds * 10) % 10}" if tenths else text


def event_time(event: ReplayEvent) -> str:
    """Return the recorded clock of an event with tenths."""
    return time.strftime("%H:%M:%S", time.localtime(event.wall)) + f".{int(event.wall * 10) % 10}"
