"""ChartRecorder: connects the recorder of series with the messages, the selected vehicle and the operator's keys."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping

from dialects.messages import Message
from groundstation.intents.union import AnyIntent
from groundstation.station.charts.catalogue import FieldCatalogue, class_of, place_of
from groundstation.station.charts.marks import MarkWatcher
from groundstation.station.charts.points import PointBuffer
from groundstation.station.charts.recorder import SeriesRecorder
from groundstation.station.links.link_monitor import LinkMonitor
from groundstation.station.messages.fields import Reader, make_reader
from groundstation.station.messages.message_kind import Tap
from groundstation.station.messages.message_traffic import MessageTraffic, TrafficKey
from groundstation.station.view_feed import ViewSource
from groundstation.vehicles.fleet import Fleet
from groundstation.views.base import ViewRequest
from groundstation.views.charts import STATION, FieldId, FieldsPage, FieldsRequest, SeriesRequest

PERIOD = 0.2
"""s between two looks at the vehicle and at what the station measures, and between two pages."""

FIELDS_PERIOD = 0.3
"""s between two lists of fields."""

TAPS = "charts"


class ChartRecorder:
    """Records what is pinned or was drawn last; marks are kept at all times."""

    def __init__(
        self,
        fleet: Fleet,
        traffic: MessageTraffic,
        links: LinkMonitor,
    ) -> None:
        self._fleet = fleet
        self._traffic = traffic
        self._links = links
        self._recorder = SeriesRecorder()
        self._watcher = MarkWatcher(self._recorder.marks)
        self._catalogue = FieldCatalogue(traffic)
        self._recorded: Mapping[FieldId, PointBuffer] = {}
        self._due = 0.0

    @property
    def sources(self) -> Mapping[type[ViewRequest], ViewSource]:
        """Request -> its source."""
        return {
            SeriesRequest: ViewSource(self._recorder.build_page, PERIOD),
            FieldsRequest: ViewSource(self._build_fields, FIELDS_PERIOD),
        }

    @property
    def systems(self) -> frozenset[int]:
        """System ids of the vehicles whose fields are recorded."""
        return frozenset(field.system for field in self._recorded if not field.sent)

    def pin(self, fields: Iterable[FieldId]) -> None:
        """Record these fields also when they are not drawn any more, in place of those pinned before."""
        self._recorder.pin(fields)

    def mark_key(self, intent: AnyIntent, now: float) -> None:
        """Mark an intent that is a key of the driver. Called where keys count."""
        self._watcher.press(intent, now)

    def tick(self, now: float) -> None:
        """Mark what has changed, and record what this station measures."""
        if now < self._due:
            return
        self._due = now + PERIOD
        selected = self._fleet.selected
        if selected is not None:
            self._watcher.update(selected.state, now)
            if not self._recorder.was_asked:
                self._recorder.suggest(self._catalogue.first_view((selected.state.system, selected.state.component)))
        self._update_taps(now)
        self._measure(now)

    # ---- recording ----

    def _update_taps(self, now: float) -> None:
        recorded = self._recorder.recorded
        if recorded != self._recorded:
            self._recorded = recorded
            self._traffic.set_taps(TAPS, dict(_taps(recorded)))

    def _measure(self, now: float) -> None:
        wanted = {field.field: buffer for field, buffer in self._recorded.items() if field.message == STATION}
        contact = self._fleet.selected
        if not wanted or contact is None:
            return
        view = contact.state.build_view(now)
        links = self._links.stats.build_views(self._links.find_figures(contact, now))
        losses = [link.loss for link in links if link.loss is not None and link.counts]
        measured = {
            "round_trip": (self._links.timesync.round_trip, 1000),
            "loss": (losses[0] if losses else None, 100),
            "command_age": (view.command_age, 1000),
            "key_to_motor": (view.latency, 1000),
        }
        for name, (value, factor) in measured.items():
            if name in wanted and value is not None and view.alive:
                wanted[name].add(now, value * factor)

    # ---- fields ----

    def _build_fields(self, request: FieldsRequest, now: float, wall: float) -> FieldsPage:
        selected = self._fleet.selected
        ids = (selected.state.system, selected.state.component) if selected else (0, 0)
        return self._catalogue.build_page(request, ids)


def _taps(recorded: Mapping[FieldId, PointBuffer]) -> Iterator[tuple[TrafficKey, Tap]]:
    """Yield one tap for each kind of message that has recorded fields."""
    readers: dict[TrafficKey, list[tuple[Callable[[float, float], None], Reader]]] = {}
    for field, buffer in recorded.items():
        kind = class_of(field)
        read = make_reader(kind, field.field, field.index) if kind else None
        if read is not None:
            readers.setdefault(place_of(field), []).append((buffer.add, read))
    for place, pairs in readers.items():
        yield place, _make_tap(pairs)


def _make_tap(pairs: list[tuple[Callable[[float, float], None], Reader]]) -> Tap:
    def tap(message: Message, now: float) -> None:
        for add, read in pairs:
            value = read(message)
            if value is not None:
                add(now, value)

    return tap
