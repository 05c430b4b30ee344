"""ReplayPlayer: a position in a log that moves, and the station that shows it. Real time is an argument."""

from __future__ import annotations

import heapq
from bisect import bisect_left
from collections.abc import Iterable, Iterator

from dialects import messages as m
from dialects.codec import decode_frame
from groundstation.intents.charts import PinSeries
from groundstation.intents.vehicle import SelectNextVehicle, SelectVehicle
from groundstation.replay.feed import BASE, BuildStation, StationFeed
from groundstation.replay.log_index import LogIndex
from groundstation.replay.plans import RecordedPlan
from groundstation.station.station import Station
from groundstation.views.base import ViewRequest
from groundstation.views.charts import FieldId, SeriesRequest
from link.services.mission.items import MissionItem, from_message
from link.tlog.scan import LogFrame, id_of

SPEEDS = (0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0)

FRAMES_PER_STEP = 2500
"""Frames given in one step of playing: 0.1 s of work. A faster speed than the machine can do becomes slower."""

LEAD, LEAD_INTERVALS, CHART_INTERVALS = 60.0, 1, 8
"""s before a moment that are read as well, for what shows the time before; the most intervals of that without charts,
and with them."""

BACKWARDS_PERIOD = 0.25
"""s of real time between two pictures backwards: each is rebuilt."""


class ReplayPlayer:
    """Plays a log to a station, which is built anew for each seek."""

    def __init__(self, name: str, index: LogIndex, build: BuildStation, *, speed: float = 1.0) -> None:
        self._name = name
        self._index = index
        self._build = build
        self.position = 0.0
        """s since the start of the log."""
        self.playing = False
        self.backwards = False
        self.speed = speed
        self.marks: tuple[float | None, float | None] = (None, None)
        """A and B."""
        self.loop = False
        self.requests: tuple[ViewRequest, ...] = ()
        """Views that the screen watches: a new station answers them, too."""
        self._pins: tuple[FieldId, ...] = ()
        self.seeks = 0
        """Counts the stations that were built: what a screen has kept of another one is void."""
        self._next: Iterator[tuple[float, LogFrame]] = iter(())
        self._waiting: tuple[float, LogFrame] | None = None
        self.offset = 0
        """Behind the last frame that was given."""
        self._backwards_due = 0.0
        self._own: tuple[int, int] | None = None
        self._feed = StationFeed(name, build, None, 0.0)
        self._plans = ShownPlans(index, self._feed.station, 0)

    @property
    def station(self) -> Station:
        """The station at this position."""
        return self._feed.station

    @property
    def keys(self) -> tuple[str, ...]:
        """Drive keys that were held at this position."""
        return self._feed.keys

    @property
    def own(self) -> tuple[int, int] | None:
        """The ground station whose frames count as sent: the one that wrote the log, as far as it can be told."""
        stations = self._index.findings.finder.stations
        return min(stations, key=lambda ids: (-ids[0], ids[1]), default=None)

    @property
    def end(self) -> float:
        """Where playing ends: B in a loop, else the end of the log as far as it is indexed."""
        _, mark = self.marks
        return mark if self.loop and mark is not None else self._index.duration

    def update_own(self) -> None:
        """Show the log anew once the index has found the ground station that wrote it."""
        if self.own != self._own:
            self.refresh()

    # ---- the position ----

    def seek(self, time: float) -> None:
        """Go to a time: build the state there."""
        self.position = max(0.0, min(time, self._index.duration))
        self._rebuild(self.position, None)

    def seek_offset(self, time: float, offset: int) -> None:
        """Go to just behind the record at an offset; `time` is its time."""
        self.position = max(0.0, min(time, self._index.duration))
        self._rebuild(self.position, offset)

    def _rebuild(self, time: float, offset: int | None) -> None:
        """Build a station, give it what was valid before the interval, then the interval up to here."""
        before, self.seeks = self._feed.station, self.seeks + 1
        number = self._index.find_interval(time) if offset is None else self._index.interval_of(offset)
        number = self._lead(number, time)
        start = self._index.times[number] if len(self._index.times) else 0.0
        self._own = self.own
        self._feed = StationFeed(self._name, self._build, self._own, start)
        if not len(self._index.starts):
            return
        self._prepare(start)
        for time_before, frame in state_before(self._index, number):
            self._feed.prime(frame, time_before)
        self._plans = ShownPlans(self._index, self._feed.station, self._index.starts[number])
        self._next, self._waiting = self._frames_from(number), None
        self._select(before)
        self._play_to(time, None, offset)
        self._feed.pass_time(time)

    def _lead(self, number: int, time: float) -> int:
        """Return the interval from which to read: rates, tracks and charts show the time before as well."""
        most = CHART_INTERVALS if self._pins or self._drawn else LEAD_INTERVALS
        return max(0, min(number, max(self._index.find_interval(time - LEAD), number - most)))

    def _prepare(self, time: float) -> None:
        """Have the new station record and answer what the one before did."""
        self._feed.station.views.watch(self.requests)
        self._record(time)

    def _record(self, time: float) -> None:
        """Record what is drawn like what is pinned: at 32 times the speed no screen asks often enough."""
        fields = tuple(dict.fromkeys([*self._pins, *sorted(self._drawn)]))
        self.station.handle_intent(PinSeries(fields), BASE + time)

    def watch(self, requests: tuple[ViewRequest, ...]) -> None:
        """Answer these requests of the screen from now on."""
        before = self._drawn
        self.requests = requests
        if self._drawn - before:
            self.refresh()  # new charts show the time before, too
        else:
            self.station.views.watch(requests)

    @property
    def _drawn(self) -> frozenset[FieldId]:
        return frozenset(field for each in self.requests if isinstance(each, SeriesRequest) for field in each.fields)

    def refresh(self) -> None:
        """Build the station of this moment anew."""
        self.seek_offset(self.position, max(0, self.offset - 1))

    def pin(self, fields: tuple[FieldId, ...]) -> None:
        """Record these fields for charts, also while no screen draws them."""
        self._pins = fields
        self._record(self.position)

    def select(self, intent: SelectVehicle | SelectNextVehicle) -> None:
        """Show another vehicle."""
        self.station.handle_intent(intent, BASE + self.position)

    def _select(self, before: Station) -> None:
        """Keep the choice of the vehicle."""
        selected = before.fleet.selected
        if selected is not None and self.station.fleet.get(selected.state.system) is not None:
            self.station.fleet.select(selected.state.system, BASE + self.position)

    def _frames_from(self, number: int) -> Iterator[tuple[float, LogFrame]]:
        while number < len(self._index.starts):
            yield from self._index.timed_frames(number)
            number += 1

    def _play_to(self, time: float, most: int | None, offset: int | None = None) -> bool:
        """Give the frames up to a time, or up to the record at an offset. Returns False after `most` frames."""
        while (pair := self._waiting or next(self._next, None)) is not None:
            at, frame = pair
            if (at > time) if offset is None else (frame.at > offset):
                self._waiting = pair
                return True
            if most is not None and most <= 0:
                self._waiting = pair
                return False
            self._waiting = None
            self._give(frame, at)
            most = None if most is None else most - 1
        return True

    def _give(self, frame: LogFrame, time: float) -> None:
        self._feed.give(frame, time)
        self._plans.advance(frame.at)
        self.offset = frame.end

    # ---- playing ----

    def advance(self, seconds: float, now: float) -> None:
        """Let real time pass while the log plays. `now`: real time, s."""
        if not self.playing or not len(self._index.starts):
            return
        if self.backwards:
            self._advance_backwards(now)
        else:
            self._advance_forward(seconds)

    def _advance_forward(self, seconds: float) -> None:
        target = min(self.position + seconds * self.speed, self.end)
        if self._play_to(target, FRAMES_PER_STEP):
            self.position = target
        elif self._waiting is not None:
            self.position = max(self.position, min(self._waiting[0], target))
        self._feed.pass_time(self.position)
        if self.position >= self.end:
            self._reach_end()

    def _advance_backwards(self, now: float) -> None:
        if now < self._backwards_due:
            return
        self._backwards_due = now + BACKWARDS_PERIOD
        first = self.marks[0] if self.loop and self.marks[0] is not None else 0.0
        target = self.position - BACKWARDS_PERIOD * self.speed
        self.seek(max(first, target))
        if target <= first:
            self._reach_end()

    def _reach_end(self) -> None:
        if not self.loop or self.marks[0] is None:
            self.playing = not self._index.complete and not self.backwards
            return
        self.seek(self._index.duration if self.backwards and self.marks[1] is None else self._loop_start())

    def _loop_start(self) -> float:
        first, last = self.marks
        wanted = last if self.backwards else first
        return wanted if wanted is not None else 0.0

    def step(self, messages: int) -> None:
        """Go so many messages forward, or back."""
        self.playing = False
        if messages < 0:
            self._step_back(-messages)
            return
        for _ in range(messages):
            pair, self._waiting = self._waiting or next(self._next, None), None
            if pair is None:
                return
            at, frame = pair
            self.position = max(self.position, at)
            self._give(frame, at)

    def _step_back(self, count: int) -> None:
        """Go to just behind the record so many before the last one that was given."""
        number = self._index.interval_of(max(0, self.offset - 1))
        frames = [pair for pair in self._index.timed_frames(number) if pair[1].end < self.offset]
        while len(frames) < count and number > 0:
            number -= 1
            frames = [*self._index.timed_frames(number), *frames]
        if frames:
            time, frame = frames[max(0, len(frames) - count)]
            self.seek_offset(time, frame.at)

    # ---- speed and marks ----

    def change_speed(self, step: int) -> None:
        """Choose the next higher or lower speed."""
        at = bisect_left(SPEEDS, self.speed)
        self.speed = SPEEDS[max(0, min(at + step, len(SPEEDS) - 1))]

    def mark(self) -> None:
        """Mark A, then B; a third mark begins anew. B is never before A."""
        first, last = self.marks
        if first is None or last is not None:
            self.marks, self.loop = (self.position, None), False
        else:
            self.marks = min(first, self.position), max(first, self.position)


TRACK = 200
"""Positions from before, one of each interval: the track on the map."""

TEXTS = 150
"""Texts from before."""

MAX_FRAMES = 4000
"""Frames in all; a station reads them in 0.2 s."""

_TRACKED = {m.GlobalPositionInt.id, m.LocalPositionNed.id, m.VfrHud.id}


def state_before(index: LogIndex, number: int) -> Iterator[tuple[float, LogFrame]]:
    """Yield times and frames from before an interval, in the order of the file.

    HEARTBEATs go first, at time 0: without them a station does not know the vehicles that the others are from.
    """
    start = index.starts[number]
    places: set[int] = set()
    first: list[int] = []
    for key, offsets in index.places.items():
        if at := bisect_left(offsets, start):
            count = TRACK if id_of(key) in _TRACKED else 1
            places.update(offsets[max(0, at - count) : at])
            if id_of(key) == m.Heartbeat.id:
                first.append(offsets[at - 1])
    places.update(index.findings.kept_before(start, TEXTS))
    places.update(index.findings.params_before(start))
    yield from ((0.0, frame) for frame in _read(index, first))
    latest = index.times[number]
    for frame in _read(index, heapq.nlargest(MAX_FRAMES, places)):
        yield min(latest, index.clock.elapsed(frame.at, frame.stamp)), frame


def _read(index: LogIndex, offsets: Iterable[int]) -> Iterator[LogFrame]:
    for offset in sorted(offsets):
        frame = index.read_frame(offset)
        if frame is not None:
            yield frame


class ShownPlans:
    """The plans of one station, which begins at an offset of the log."""

    def __init__(self, index: LogIndex, station: Station, offset: int) -> None:
        """Give it the newest plan of each vehicle and kind from before the offset."""
        self._index = index
        self._station = station
        self._next = 0
        newest: dict[tuple[int, int], tuple[int, RecordedPlan]] = {}
        changes = index.findings.plans.changes
        while self._next < len(changes) and changes[self._next].offset < offset:
            change = changes[self._next]
            self._next += 1
            newest[change.system, change.kind] = self._next, change
        for number, change in newest.values():
            self._show(number, change)

    def advance(self, offset: int) -> None:
        """Give it the plans up to the record at an offset."""
        changes = self._index.findings.plans.changes
        while self._next < len(changes) and changes[self._next].offset <= offset:
            self._next += 1
            self._show(self._next, changes[self._next - 1])

    def _show(self, number: int, change: RecordedPlan) -> None:
        contact = self._station.fleet.get(change.system)
        if contact is None:
            return
        plans = self._station.services.services_of(contact).plans
        found = [self._read(offset) for offset in change.items or ()]
        items = [item for item in found if item is not None]
        if change.items is None or len(items) < len(found):
            plans.forget(change.kind)
        else:
            plans.take(change.kind, tuple(items), number, change.plan_id)

    def _read(self, offset: int) -> MissionItem | None:
        frame = self._index.read_frame(offset)
        message = None if frame is None else decode_frame(frame.message_id, frame.raw)
        return from_message(message) if isinstance(message, (m.MissionItem, m.MissionItemInt)) else None
