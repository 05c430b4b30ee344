"""LogReplay: one open log. Intents of the screen move in it; snapshots and views show it. Real time is an argument."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import msgspec

from groundstation.intents import replay as r
from groundstation.intents.charts import PinSeries
from groundstation.intents.driving import STOP_KEY, DriveKeyDown, DriveKeyUp, DrivePad, EmergencyStop, ReleasePad, Stop
from groundstation.intents.union import AnyIntent
from groundstation.intents.vehicle import SelectNextVehicle, SelectVehicle
from groundstation.intents.watch import Watch
from groundstation.replay.feed import BASE, BuildStation
from groundstation.replay.log_check import LogCheck
from groundstation.replay.log_index import LogIndex
from groundstation.replay.log_search import LogSearch
from groundstation.replay.picture import build_view
from groundstation.replay.player import ReplayPlayer
from groundstation.replay.query import QueryError, parse_query
from groundstation.replay.source import LogSource
from groundstation.replay.time_text import TimeError, parse_time
from groundstation.snapshot import ReplayStatus, Snapshot
from groundstation.station.view_feed import ViewFeed, ViewSource
from groundstation.views.base import View, ViewRequest
from groundstation.views.camera import CameraRequest, CameraView
from groundstation.views.replay import ReplayRequest, ReplayView

VIEW_PERIOD = 0.1
"""s between two views of the Replay screen."""

FIRST_VEHICLE = 10.0
"""s from the start within which the first picture waits for a vehicle."""


class LogReplay:
    """A log with its index, its player and its search. `path`: of the file."""

    def __init__(self, path: str, source: LogSource, build: BuildStation, *, at: str = "", speed: float = 1.0) -> None:
        self.path = path
        self.name = name = path.rpartition("/")[2]
        self.source = source
        self.index = LogIndex(source)
        self.check = LogCheck(self.index)
        self.player = ReplayPlayer(name, self.index, build, speed=speed)
        self.search: LogSearch | None = None
        self.note, self.notes = "", 0
        self._wanted = at
        """A time to go to once the index has it."""
        self._shown = False
        self._time: float | None = None
        self._feed = ViewFeed(
            {
                ReplayRequest: ViewSource(self._build_view, VIEW_PERIOD),
                CameraRequest: ViewSource(self._build_camera, VIEW_PERIOD),
            }
        )
        self._snapshots = self._refused = 0

    # ---- work ----

    def work(self) -> bool:
        """Do a few ms of work in the background. Returns whether there is more to do."""
        if self.search is not None:
            self._work_search(self.search)
            return True
        if not self.index.complete:
            self.index.advance()
            self._show_first()
            self._go_to_wanted()
            return True
        return self.check.advance()

    def _show_first(self) -> None:
        """Show the first moment with a vehicle, as soon as the index has something."""
        if not self._shown and len(self.index.starts):
            self._shown = True
            vehicles = self.index.findings.finder.vehicles.values()
            first = min((each.found for each in vehicles), default=0.0)
            self.player.seek(first if first < FIRST_VEHICLE else 0.0)
        self.player.update_own()

    def _go_to_wanted(self) -> None:
        if not self._wanted or not len(self.index.starts):
            return
        try:
            time = parse_time(self._wanted, self.index.clock, self.player.position)
        except TimeError as error:
            self._wanted = ""
            self.say(str(error))
            return
        if time < self.index.duration or self.index.complete:
            self._wanted = ""
            self.player.seek(time)

    def _work_search(self, search: LogSearch) -> None:
        if search.advance():
            return
        self.search = None
        if search.found is None:
            more = "" if self.index.complete else " in what is indexed so far"
            self.say(f"not found{more}: {search.query.text}")
            return
        self.player.playing = False
        self.player.seek_offset(*search.found)
        self.say(f"found{' from the start again' if search.wrapped else ''}: {search.query.text}")

    def advance(self, now: float) -> None:
        """Let the log play up to now."""
        passed = 0.0 if self._time is None else now - self._time
        self._time = now
        self.player.advance(passed, now)

    def say(self, text: str) -> None:
        """Answer the newest key in one line."""
        self.note, self.notes = text, self.notes + 1

    # ---- the screen ----

    def handle(self, intent: AnyIntent) -> None:
        """Carry out an intent that only looks; all others do nothing here, because nothing is ever sent."""
        handler = _HANDLERS.get(type(intent))
        if handler is not None:
            handler(self, intent)
        elif intent.is_input and not isinstance(intent, (DriveKeyDown, DriveKeyUp, DrivePad, ReleasePad)):
            self._refused += 1

    def snapshot(self) -> Snapshot:
        """Build the snapshot of this moment."""
        self._snapshots += 1
        station, position = self.player.station, self.player.position
        snapshot = station.snapshot(BASE + position, self.index.clock.wall(position))
        return msgspec.structs.replace(
            snapshot,
            number=self._snapshots,
            endpoints=(self.name,),
            faults=0,
            waiting=None if snapshot.vehicle else "no vehicle yet at this moment of the log",
            operator=msgspec.structs.replace(snapshot.operator, held=self.player.keys),
            replay=self._status(),
        )

    def _status(self) -> ReplayStatus:
        player = self.player
        return ReplayStatus(
            file=self.name,
            wall=self.index.clock.wall(player.position),
            position=player.position,
            duration=self.index.duration,
            playing=player.playing,
            backwards=player.backwards,
            speed=player.speed,
            seeks=player.seeks,
            refused=self._refused,
            indexed=self.index.progress,
        )

    def send_views(self, send: Callable[[View], bool], now: float) -> None:
        """Send the views that are due and have changed. `now`: real time, s."""
        position = self.player.position
        wall = self.index.clock.wall(position)
        self._feed.send_due(send, now, wall)
        self.player.station.views.send_due(send, BASE + position, wall, paced_by=now)

    def _build_view(self, request: ReplayRequest, now: float, wall: float) -> ReplayView:
        return build_view(self, request)

    def _build_camera(self, request: CameraRequest, now: float, wall: float) -> CameraView | None:
        selected = self.player.station.fleet.selected
        return None if selected is None else CameraView(selected.state.system, log=self.path, at=wall)

    def _watch(self, requests: tuple[ViewRequest, ...]) -> None:
        self._feed.watch(requests)
        self.player.watch(tuple(each for each in requests if not isinstance(each, CameraRequest)))

    # ---- moving ----

    def _play(self, playing: bool) -> None:
        player = self.player
        if playing and not player.backwards and player.position >= player.end and self.index.complete:
            player.seek(0.0)
        player.playing = playing

    def _reverse(self) -> None:
        self.player.backwards = not self.player.backwards
        self.player.playing = True

    def _move(self, seconds: float) -> None:
        self.player.seek(self.player.position + seconds)

    def _next_event(self, step: int) -> None:
        events, position = self.index.findings.finder.events, self.player.position
        number = events.place(position, after=True) if step > 0 else events.place(position) - 1
        if 0 <= number < len(events):
            self._show_event(number)
        else:
            self.say("no further event" if step > 0 else "no event before")

    def _show_event(self, number: int) -> None:
        events = self.index.findings.finder.events
        if 0 <= number < len(events):
            self.player.playing = False
            self.player.seek_offset(events[number].time, events[number].offset)

    def _go_to(self, text: str) -> None:
        self._wanted = text
        self._go_to_wanted()
        if self._wanted:
            self.say(f"goes to {text.strip()} once the index has it")

    def _mark(self) -> None:
        self.player.mark()
        last = self.player.marks[1]
        self.say("mark A; m again marks B" if last is None else "marks A and B; l plays from A to B again and again")

    def _loop(self) -> None:
        if self.player.marks[1] is None:
            self.say("mark A and B first: m")
            return
        self.player.loop = not self.player.loop
        if self.player.loop and self.player.marks[0] is not None:
            self.player.seek(self.player.marks[0])
            self.player.playing = True

    def _search(self, text: str) -> None:
        self.search = None
        if not text:
            return
        try:
            query = parse_query(text)
        except QueryError as error:
            self.say(str(error))
        else:
            self.search = LogSearch(self.index, query, self.player.position, self.player.offset)

    def _stop(self, stop: Stop | EmergencyStop) -> None:
        """Pause: a stop key has nothing else to stop."""
        if isinstance(stop, EmergencyStop) or stop.reason == STOP_KEY:
            self.player.playing = False


_HANDLERS: dict[type[Any], Callable[[LogReplay, Any], None]] = {
    Watch: lambda replay, intent: replay._watch(intent.requests),
    PinSeries: lambda replay, intent: replay.player.pin(intent.fields),
    SelectVehicle: lambda replay, intent: replay.player.select(intent),
    SelectNextVehicle: lambda replay, intent: replay.player.select(intent),
    Stop: LogReplay._stop,
    EmergencyStop: LogReplay._stop,
    r.ReplayPlay: lambda replay, intent: replay._play(intent.playing),
    r.ReplayReverse: lambda replay, intent: replay._reverse(),
    r.ReplayMove: lambda replay, intent: replay._move(intent.seconds),
    r.ReplayStep: lambda replay, intent: replay.player.step(intent.messages),
    r.ReplayNextEvent: lambda replay, intent: replay._next_event(intent.step),
    r.ReplayShowEvent: lambda replay, intent: replay._show_event(intent.number),
    r.ReplayGoTo: lambda replay, intent: replay._go_to(intent.text),
    r.ReplaySpeed: lambda replay, intent: replay.player.change_speed(intent.step),
    r.ReplayMark: lambda replay, intent: replay._mark(),
    r.ReplayLoop: lambda replay, intent: replay._loop(),
    r.ReplaySearch: lambda replay, intent: replay._search(intent.text),
}
"""Intent -> what it does. Every intent that is not here is dropped."""
