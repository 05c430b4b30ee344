"""Replay screen: the timeline and the events of a log, the map and the drive of its moment, and the keys that move."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path

import msgspec
from textual import events
from textual.containers import Horizontal, Vertical
from textual.widget import Widget

from groundstation.intents import replay as r
from groundstation.intents.union import AnyIntent
from groundstation.ui.base.list_keys import rows_to_move
from groundstation.ui.base.local_files import LocalFile, short_path
from groundstation.ui.base.screen import LIST_ARROWS, ConsoleScreen, ScreenContext
from groundstation.ui.display.display_state import DisplayState, ScreenInfo, ScreenKey
from groundstation.ui.display.wrap import plain
from groundstation.ui.drive.camera_feed import CameraFeed, CameraValue
from groundstation.ui.drive.instruments.camera import CameraPicture
from groundstation.ui.drive.instruments.keycaps import Keycaps, KeycapsValue
from groundstation.ui.drive.instruments.sticks import StickBars, build_bars
from groundstation.ui.drive.instruments.track import TrackMap, TrackValue
from groundstation.ui.drive.panes import SPEED_CHART, PaneInput, speed_samples
from groundstation.ui.drive.picture_drawing import PictureDrawing
from groundstation.ui.files.export import ChosenLog, FileExport
from groundstation.ui.files.exports import Exports
from groundstation.ui.files.local_folder import LocalFolder
from groundstation.ui.replay.events import events_value, logs_value
from groundstation.ui.replay.model import ReplayModel, event_time, part_text, short_summary, summary
from groundstation.ui.replay.timeline import AXIS, ReplayTimeline, TimelineValue
from groundstation.ui.terminal.key_parser import KeyRepeat
from groundstation.ui.widgets.chart import ChartValue
from groundstation.ui.widgets.line_field import FieldUse
from groundstation.ui.widgets.row_table import RowTable
from groundstation.views.base import View, ViewRequest
from groundstation.views.camera import CameraView
from groundstation.views.drive import SpeedRequest, SpeedView, TrackRequest, TrackView
from groundstation.views.replay import ReplayView

TLOG = ".tlog"
CLOSED_KEYS = (
    ScreenKey("enter", "Open", "Show the telemetry log under the cursor in all screens, until Ctrl-Q"),
    ScreenKey("y", "Copy", "Copy the path of the log"),
)
"""Keys while no log is open."""
WIDE = 120


class ReplayScreen(ConsoleScreen):
    """Track, drive and events over the timeline; without a log the logs that are here."""

    CSS_PATH = "screen.tcss"
    HORIZONTAL_BREAKPOINTS = [(0, "-narrow"), (WIDE, "-wide")]  # noqa: RUF012 - Textual declares it so
    KEYS = (
        ScreenKey("p", "Play", "Play, or pause; SPACE pauses on every screen"),
        ScreenKey("right", "1 s", "1 s on, with shift 10 s; left: back"),
        ScreenKey("n", "Event", "Next event; N: the one before; up, down and ENTER choose one"),
        ScreenKey("greater_than_sign", "Faster", "Play faster, up to 32 times; < slower, down to a quarter"),
        ScreenKey("slash", "Search", "Next event with a text, next message of a name, or a condition: batt<11.5"),
        ScreenKey("colon", "Time", "Go to 12:04:10 by the clock of the log, +30, -30, or 1:23 from its start"),
        ScreenKey("full_stop", "Message", "One message on; comma: back"),
        ScreenKey("r", "Backwards", "Play in the other direction"),
        ScreenKey("m", "Mark", "Mark A, then B"),
        ScreenKey("l", "Loop", "Play from A to B again and again"),
        ScreenKey("v", "View", "The recorded picture of the camera in place of the track, and back"),
        ScreenKey("E", "Export", "Write this log, or its part from A to B, for other programs; x stops it"),
    )

    def __init__(self, context: ScreenContext) -> None:
        super().__init__(context)
        self._model = context.keep(ReplayModel)
        exports = context.keep(Exports, context.dialect)
        self._export = FileExport(self, self._chosen_log, context.folder, exports, context.numbers.take)
        self._track = TrackMap(TrackValue(), id="track")
        self._picture = CameraPicture(CameraValue(), id="picture")
        self._camera = CameraFeed(self._show_picture, context.pictures)
        self._drawing = PictureDrawing(self, self._camera, self._picture_value)
        self._bars = StickBars((), id="bars")
        self._caps = Keycaps(KeycapsValue(context.keymap), id="caps")
        self._chart = SPEED_CHART(ChartValue(), id="chart")
        self._events = RowTable(events_value(self._model), id="events")
        self._timeline = ReplayTimeline(TimelineValue(), id="timeline")
        self._logs = RowTable(logs_value((), {}), id="logs")
        self._disk = LocalFolder(context.folder)
        self._disk.scan()
        self._cursor = 0
        self._views: dict[type[View], View] = {}

    # ---- what all screens define ----

    def compose_body(self) -> Iterable[Widget]:
        """Lay out what was then over the timeline."""
        track = self.build_panel(self._track, "track then")
        drive = Vertical(self._bars, self._caps, id="drive")
        middle = Vertical(
            self.build_panel(drive, "drive then"), self.build_panel(self._chart, "speed then"), id="middle"
        )
        picture = self.build_panel(self._picture, "camera then")
        yield Horizontal(track, picture, middle, self.build_panel(self._events, "events"), id="then")
        yield self.build_panel(self._timeline, "timeline")
        yield self.build_panel(self._logs, "logs here")

    def on_mount(self) -> None:
        """List the logs, and mark the panel that the arrows move in."""
        self._events.add_class("-chosen")
        self.set_class(not self._open, "-empty")
        self._show_logs()
        if not self._open:
            self.run_worker(self._read_summaries())

    @property
    def _open(self) -> bool:
        return self._state.snapshot.replay is not None

    def requests(self) -> tuple[ViewRequest, ...]:
        """Return the requests for the log and for what was then."""
        if not self._open:
            return ()
        request = self._model.request(self._timeline.size.width - AXIS, self._events.size.height)
        shown = self._camera.request if self._shows_picture else TrackRequest()
        return request, shown, SpeedRequest()

    def show_view(self, view: View) -> None:
        """Show a view."""
        self._views[type(view)] = view
        if isinstance(view, ReplayView):
            self.say(self._model.show_view(view))
        self.show_body(self._state)

    @property
    def _shows_picture(self) -> bool:
        return self.has_class("-picture")

    def _switch_picture(self) -> None:
        self.set_class(not self._shows_picture, "-picture")
        self.show_body(self._state)

    def _picture_value(self) -> CameraValue:
        return self._camera.value(ascii=self._state.ascii, command_age=None)

    @property
    def _pictures(self) -> list[CameraPicture]:
        return [self._picture] if self._shows_picture else []

    def _show_picture(self) -> None:
        self._drawing.show(self._pictures)

    def leave(self) -> None:
        """End the decoder: another screen is on top."""
        self._drawing.stop()

    def show_body(self, now: DisplayState) -> None:
        """Show the log and its moment, or the logs that are here."""
        self.set_class(not self._open, "-empty")
        given = PaneInput(now, self._views)
        track = given.view(TrackView)
        points = track.points if track is not None else ()
        self._track.show(TrackValue.from_vehicle(now.snapshot.vehicle, points, ascii=now.ascii))
        self._drawing.follow(given.view(CameraView), self._pictures)
        for picture in self._pictures:
            picture.show(self._picture_value())
        self._drawing.draw_pixels(self._pictures)
        self._bars.show(build_bars(now.snapshot))
        self._caps.show(KeycapsValue.from_state(now))
        if given.view(SpeedView) is not None:
            self._chart.show(speed_samples(given))
        self._events.show(events_value(self._model))
        self._timeline.show(TimelineValue(self._model.view, now.ascii))
        self._export.tell_end()
        view = self._model.view
        if view is not None:
            self._timeline.border_subtitle = plain(summary(view) if self.room.width >= WIDE else short_summary(view))
            self._events.border_subtitle = plain(f"{view.total} · / searches")

    @property
    def advice(self) -> str:
        """Return what happened at this moment."""
        return (
            self._export.progress or self._model.advice
            if self._open
            else "ENTER shows a log in all screens, until Ctrl-Q; nothing is sent meanwhile"
            if self._files
            else f"no telemetry log in {short_path(self.context.folder)} yet: each drive is recorded there"
        )

    # ---- keys ----

    def perform_key(self, event: events.Key) -> bool:
        """Handle the keys of this screen."""
        if not self._open:
            return self._choose_log(event)
        intent = _INTENTS.get(event.key)
        if event.key == "escape" and self._cancel():
            return True
        if rows := rows_to_move(event.key, self._events.size.height):
            self._model.move_cursor(rows)
        elif intent is not None:
            self._send(intent)
        elif event.key in _ACTIONS:
            if not isinstance(event, KeyRepeat):
                _ACTIONS[event.key](self)
        else:
            return False
        return True

    def choose_panel_of(self, widget: Widget) -> tuple[str, str] | None:
        """Move in the list of events, or of logs while none is open; over the timeline the wheel goes back and on."""
        if widget is self._timeline and self._open:
            return "left", "right"
        return LIST_ARROWS if widget is (self._events if self._open else self._logs) else None

    @property
    def marked_text(self) -> str:
        """The event under the cursor with its time; the path of the log while none is open."""
        if self._open:
            event = self._model.marked
            return f"{event_time(event)} {event.text}" if event is not None else ""
        return str(self.context.folder / self._files[self._cursor].name) if self._files else ""

    def describe(self) -> ScreenInfo:
        """Return the keys that work now: without an open log those that open one."""
        info = super().describe()
        return info if self._open else msgspec.structs.replace(info, keys=CLOSED_KEYS)

    def _choose_log(self, event: events.Key) -> bool:
        if rows := rows_to_move(event.key, self._logs.size.height):
            self._cursor = max(0, min(self._cursor + rows, len(self._files) - 1))
            self._show_logs()
        elif event.key not in ("enter", "o"):
            return False
        elif not isinstance(event, KeyRepeat):
            self.open_log(self.context.folder / self._files[self._cursor].name if self._files else None)
        return True

    @property
    def _files(self) -> list[LocalFile]:
        """The telemetry logs that are listed."""
        return [each for each in self._disk.files if each.name.endswith(TLOG) and not self._is_start(each)]

    def _is_start(self, file: LocalFile) -> bool:
        found = self._disk.summaries.get(file)
        return found is not None and found.is_start

    async def _read_summaries(self) -> None:
        marked = self._files[self._cursor] if self._files else None
        await self._disk.read_summaries()
        files = self._files
        self._cursor = files.index(marked) if marked in files else max(0, min(self._cursor, len(files) - 1))
        self._show_logs()

    def _show_logs(self) -> None:
        hidden = sum(map(self._is_start, self._disk.files))
        self._logs.show(logs_value(self._files, self._disk.summaries, self._cursor, hidden))

    def _send(self, intent: AnyIntent) -> None:
        self._model.cursor = None
        self.context.send(intent)

    def _cancel(self) -> bool:
        """End a search, or the choice of an event."""
        view = self._model.view
        searching = view is not None and bool(view.searching)
        if not searching and self._model.cursor is None:
            return False
        self._send(r.ReplaySearch(""))
        return True

    def _play(self) -> None:
        replay = self._state.snapshot.replay
        self._send(r.ReplayPlay(replay is not None and not replay.playing))

    def _show_event(self) -> None:
        if (chosen := self._model.chosen) is not None:
            self._send(r.ReplayShowEvent(chosen))

    def _ask_search(self) -> None:
        use = FieldUse(self._search)
        example = "text, HOME_POSITION, MODE==AUTO, batt<11.5, VFR_HUD.groundspeed>2"
        self.field.open(use, text=self._model.search, placeholder=example, selected=True)

    def _search(self, text: str) -> None:
        self._model.search = text
        self._send(r.ReplaySearch(text))

    def _ask_time(self) -> None:
        use = FieldUse(lambda text: self._send(r.ReplayGoTo(text)) if text.strip() else None)
        self.field.open(use, placeholder="12:04:10 · +30 · -30 · 1:23")

    def _chosen_log(self) -> ChosenLog | str:
        view = self._model.view
        return ChosenLog(Path(view.path), part_text(view)) if view is not None else "the log is not read yet"


_INTENTS: dict[str, AnyIntent] = {
    "left": r.ReplayMove(-1.0),
    "right": r.ReplayMove(1.0),
    "shift+left": r.ReplayMove(-10.0),
    "shift+right": r.ReplayMove(10.0),
    "comma": r.ReplayStep(-1),
    "full_stop": r.ReplayStep(1),
    "n": r.ReplayNextEvent(1),
    "N": r.ReplayNextEvent(-1),
    "less_than_sign": r.ReplaySpeed(-1),
    "greater_than_sign": r.ReplaySpeed(1),
    "r": r.ReplayReverse(),
    "m": r.ReplayMark(),
    "l": r.ReplayLoop(),
}
"""Key -> its intent."""

_ACTIONS: dict[str, Callable[[ReplayScreen], object]] = {
    "p": ReplayScreen._play,
    "enter": ReplayScreen._show_event,
    "slash": ReplayScreen._ask_search,
    "colon": ReplayScreen._ask_time,
    "v": ReplayScreen._switch_picture,
    "E": lambda screen: screen._export.ask(),
    "x": lambda screen: screen._export.cancel(),
}
"""Key -> what it does; ReplayScreen.KEYS has their names."""
