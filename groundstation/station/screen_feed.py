"""ScreenFeed: what screens are shown of a core beside its own state, and what a recording keeps of it."""

from __future__ import annotations

from collections.abc import Sequence

from dialects.enums import StationEventKind as Kind
from dialects.messages import Message
from groundstation.intents.charts import PinSeries
from groundstation.intents.union import AnyIntent
from groundstation.intents.watch import Watch
from groundstation.station.charts.chart_recorder import ChartRecorder
from groundstation.station.core_parts import CoreParts
from groundstation.station.doctor_feed import DoctorFeed
from groundstation.station.driving.permission import Permission
from groundstation.station.intent_handler import Rows
from groundstation.station.messages.message_detail import MessageInspector
from groundstation.station.messages.message_traffic import MessageTraffic
from groundstation.station.notes.station_notes import StationNotes
from groundstation.station.services.camera_watch import CameraWatch
from groundstation.station.views.param_texts import ParamTexts
from groundstation.station.views.sources import build_view_feed
from groundstation.vehicles.fleet import Contact
from groundstation.views.doctor import DoctorRequest
from link.core import LinkReport, Received


class ScreenFeed(DoctorFeed):
    """Views, charts, message traffic, doctor, display and notes of one core, for all of its screens."""

    def __init__(self, parts: CoreParts, texts: ParamTexts) -> None:
        super().__init__(parts)
        fleet, links = parts.fleet, parts.links
        self._traffic = MessageTraffic(*parts.ids)
        self._detail = MessageInspector(self._traffic)
        self._charts = ChartRecorder(fleet, self._traffic, links)
        self.camera = CameraWatch(fleet, parts.commander, links.timesync)
        self.notes = StationNotes(parts.operator, fleet)
        parts.log.listener = self.notes.add_line
        parts.proposals.take_note = lambda now, text: self.notes.add(now, Kind.REQUEST, text)
        shown = (self._charts, self._detail, self.doctor, self._display, self.camera)
        self.views = build_view_feed(parts, texts.files, *(each.sources for each in shown))

    @property
    def handlers(self) -> Rows:
        """Intents that only screens have, and who carries them out."""
        return {
            Watch: lambda intent, now: self.views.watch(intent.requests),
            PinSeries: lambda intent, now: self._charts.pin(intent.fields),
            **super().handlers,
        }

    @property
    def is_watched(self) -> bool:
        """Whether a screen shows the chain."""
        return self.views.is_watching(DoctorRequest)

    # ---- CoreListener ----

    @property
    def systems(self) -> frozenset[int]:
        """System ids of the vehicles whose fields are drawn, or whose messages are shown."""
        return self._charts.systems | self._detail.systems(self.views)

    def hear(self, received: Received, contact: Contact | None, now: float) -> None:
        """Count a message of any system."""
        autopilot = contact is not None and contact.state.component == received.component
        self._traffic.count(received.message, received.system, received.component, now, known=autopilot)

    def receive(self, contact: Contact, received: Received, now: float) -> None:
        """Handle a message of a vehicle for its display and its camera."""
        super().receive(contact, received, now)
        self.camera.receive(contact, received)

    def end_tick(self, now: float) -> None:
        """Count and record what is shown, and examine the chain."""
        self._traffic.tick(now)
        self._charts.tick(now)
        self._detail.tick(now)
        self.camera.tick(now)
        super().end_tick(now)

    def begin_intent(self, intent: AnyIntent, permission: Permission, now: float) -> None:
        """Mark a key in the charts, where keys count; other inputs than those of Setup end the test of a motor."""
        if permission.screen is None:
            self._charts.mark_key(intent, now)
        super().begin_intent(intent, permission, now)

    def repeat_key(self, push: AnyIntent, now: float) -> None:
        """Mark a repeat of a key that drives."""
        self._charts.mark_key(push, now)

    def follow(self, intent: AnyIntent | None, permission: Permission, now: float) -> None:
        """Note what an intent, or time, has changed."""
        self.notes.follow(intent, permission, now)

    def observe(self, reports: Sequence[LinkReport], now: float) -> None:
        """Store the reports of the open links."""
        self.notes.observe(reports, now)
        self._traffic.observe([*reports, *self._parts.links.station_info.not_open], now)
        states = [contact.state for contact in self._parts.fleet]
        self._traffic.set_labels({(each.system, each.component): each.name for each in states})

    def handle_sent(self, message: Message, now: float) -> None:
        """Count a message that was sent."""
        self._traffic.count_sent(message, now)
        super().handle_sent(message, now)
