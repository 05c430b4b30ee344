"""CoreListener: what an OperatorCore tells of everything that happens, to whoever shows or records it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from dialects.messages import Message
from groundstation.station.driving.permission import Permission
from groundstation.vehicles.fleet import Contact
from link.core import LinkReport, Received

if TYPE_CHECKING:
    from groundstation.intents.union import AnyIntent


class CoreListener:
    """Listens and does nothing: that of a core without a screen. ScreenFeed is the other one."""

    @property
    def busy(self) -> bool:
        """Whether something is under way that needs all ticks."""
        return False

    @property
    def systems(self) -> frozenset[int]:
        """System ids of vehicles whose whole telemetry is needed."""
        return frozenset()

    def hear(self, received: Received, contact: Contact | None, now: float) -> None:
        """Handle a message of any system, before the parts of the core; `contact` is None if it is not a vehicle's."""

    def receive(self, contact: Contact, received: Received, now: float) -> None:
        """Handle a message of a vehicle; its state has it already."""

    def receive_exchange(self, contact: Contact, received: Received, now: float) -> None:
        """Handle one that answers a request, makes one, or decides on something (not in READINGS)."""

    def handle_text(self, contact: Contact, text: str, now: float) -> None:
        """Handle a whole STATUSTEXT of a vehicle."""

    def tick(self, now: float) -> None:
        """Do what is due while the core ticks."""

    def end_tick(self, now: float) -> None:
        """Do what is due when the core has ticked."""

    def begin_intent(self, intent: AnyIntent, permission: Permission, now: float) -> None:
        """Handle an intent that is going to be carried out."""

    def repeat_key(self, push: AnyIntent, now: float) -> None:
        """Handle a repeat of a key that drives, which is not an intent for anybody else."""

    def follow(self, intent: AnyIntent | None, permission: Permission, now: float) -> None:
        """Note that an intent was carried out, or (None) that time has passed."""

    def observe(self, reports: Sequence[LinkReport], now: float) -> None:
        """Store the reports of the open links, once a second, before the parts of the core."""

    def handle_sent(self, message: Message, now: float) -> None:
        """Note that a message was sent."""
