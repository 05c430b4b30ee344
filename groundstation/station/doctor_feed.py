"""DoctorFeed: the doctor of one core, with the display and the snapshot that it judges."""

from __future__ import annotations

from dialects.messages import Message
from groundstation.intents.union import AnyIntent
from groundstation.snapshot import Snapshot
from groundstation.station.core_listener import CoreListener
from groundstation.station.core_parts import CoreParts
from groundstation.station.doctor.diagnostics import Diagnostics
from groundstation.station.driving.permission import Permission
from groundstation.station.intent_handler import Rows
from groundstation.station.snapshot_builder import SnapshotBuilder
from groundstation.station.views.drive_display import DriveDisplay
from groundstation.vehicles.fleet import Contact
from link.core import Received


class DoctorFeed(CoreListener):
    """What the verbs `doctor` and `motor` need of a core. ScreenFeed is one with everything else that screens show."""

    def __init__(self, parts: CoreParts) -> None:
        self._parts = parts
        self._display = DriveDisplay(parts.fleet, parts.operator, parts.links.timesync, parts.ids[0])
        self._snapshots = SnapshotBuilder(parts, self._display)
        links, ids = parts.links.stats, parts.ids
        self.doctor = Diagnostics(
            parts.fleet, parts.services, parts.queries, links, parts.operator, parts.outbox, ids,
            lambda now: self.snapshot(now, now),
        )  # fmt: skip

    @property
    def handlers(self) -> Rows:
        """Intents that the core alone does not have, and who carries them out."""
        return self.doctor.handlers

    @property
    def is_watched(self) -> bool:
        """Whether somebody sees the chain and the test of a motor."""
        return True

    def snapshot(self, now: float, wall: float) -> Snapshot:
        """Build the snapshot; `now` and `wall` are the same moment on both clocks.

        It has no effect. Whoever sends it counts it (`Snapshot.number`).
        """
        return self._snapshots.build(now, wall, faults=self.doctor.faults)

    # ---- CoreListener ----

    @property
    def busy(self) -> bool:
        """A motor is tested."""
        return self.doctor.tester.busy

    def receive(self, contact: Contact, received: Received, now: float) -> None:
        """Handle a message of a vehicle for its display."""
        self._display.receive(contact, received, now)

    def receive_exchange(self, contact: Contact, received: Received, now: float) -> None:
        """Handle a message of a vehicle for the doctor."""
        self.doctor.receive(contact, received, now)

    def handle_text(self, contact: Contact, text: str, now: float) -> None:
        """Handle a whole STATUSTEXT of a vehicle for the doctor."""
        self.doctor.handle_text(contact, text, now)

    def tick(self, now: float) -> None:
        """Choose what to read of vehicles, renew or end a motor test."""
        self._display.tick(now)
        self.doctor.tick(now, watched=self.is_watched)

    def end_tick(self, now: float) -> None:
        """Examine the chain."""
        self.doctor.examine_if_due(now)

    def begin_intent(self, intent: AnyIntent, permission: Permission, now: float) -> None:
        """End the test of a motor by another input."""
        self.doctor.end_test(intent, now)

    def handle_sent(self, message: Message, now: float) -> None:
        """Note that a message was sent for the display."""
        self._display.handle_sent(message, now)
