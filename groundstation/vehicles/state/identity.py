"""What a vehicle says about itself on request: AUTOPILOT_VERSION, AVAILABLE_MODES, COMPONENT_METADATA.

Requests for messages are answered by COMMAND_ACK one at a time, so whoever owns the vehicle's commands sends them.
"""

from __future__ import annotations

import msgspec

from dialects import messages as m
from dialects.enums import Capability
from groundstation.vehicles.state.mode_list import MAX_MODES, listed_name
from link.core import Received

TRIES = 3
RETRY_AFTER = 1.0
"""s without the message before it is requested again: its COMMAND_ACK does not mean that it comes (ArduPilot)."""
NOT_SELECTABLE = 2
"""MAV_MODE_PROPERTY_NOT_USER_SELECTABLE."""


class RequestedMessage(msgspec.Struct, frozen=True):
    """Parameters 1 and 2 of REQUEST_MESSAGE."""

    message: int
    index: int = 0


VERSION = RequestedMessage(m.AutopilotVersion.id)
METADATA = RequestedMessage(m.ComponentMetadata.id)


class AvailableMode(msgspec.Struct, frozen=True):
    """One mode, as AVAILABLE_MODES reports it."""

    name: str
    custom_mode: int
    standard_mode: int
    properties: int

    @property
    def selectable(self) -> bool:
        """Whether an operator may select the mode now."""
        return not self.properties & NOT_SELECTABLE


class VehicleIdentity:
    """Collects what one component of a vehicle says about itself."""

    def __init__(self, component: int) -> None:
        self._component = component
        self.version: m.AutopilotVersion | None = None
        self.metadata: m.ComponentMetadata | None = None
        """Where its files with texts are."""
        self._wants_metadata = False
        self._modes: dict[int, AvailableMode] = {}
        self._mode_count: int | None = None
        self._monitor: int | None = None
        self._wants_modes = False
        self._asked: dict[RequestedMessage, int] = {}
        """How often each was requested."""
        self._exhausted: set[RequestedMessage] = set()
        """Requested TRIES times in vain."""
        self._last: RequestedMessage | None = None
        self._due = 0.0

    @property
    def capabilities(self) -> int:
        """MAV_PROTOCOL_CAPABILITY; 0 while not known."""
        return int(self.version.capabilities) if self.version else 0

    @property
    def settled(self) -> bool:
        """Whether the capabilities are known, or will not be."""
        return self.version is not None or VERSION in self._exhausted

    @property
    def may_have_files(self) -> bool:
        """Whether MAVLink FTP is offered, or not known."""
        return self.version is None or bool(self.capabilities & Capability.FTP)

    @property
    def modes(self) -> tuple[AvailableMode, ...] | None:
        """All modes in the vehicle's order; None while not known."""
        if self._mode_count is None or len(self._modes) < self._mode_count:
            return None
        return tuple(self._modes[index] for index in sorted(self._modes))

    @property
    def modes_settled(self) -> bool:
        """Whether the modes are known, or will not be."""
        return self.modes is not None or (self._wants_modes and self._exhausted.issuperset(self._mode_requests()))

    def want_modes(self) -> None:
        """Request the modes, if they are not known."""
        self._wants_modes = True

    def want_metadata(self) -> None:
        """Request where the files with texts are, if that is not known."""
        self._wants_metadata = True

    def receive(self, received: Received) -> None:
        """Handle a message of the vehicle; others are ignored."""
        if received.component != self._component:
            return
        match received.message:
            case m.AutopilotVersion() as message:
                self.version, self._due = message, 0.0
            case m.ComponentMetadata() as message:
                self.metadata, self._due = message, 0.0
            case m.AvailableModes() as message:
                self._add_mode(message)
            case m.AvailableModesMonitor() as message:
                if self._monitor not in (None, message.seq):  # the set of modes has changed
                    self._forget_modes()
                self._monitor = message.seq

    def next_request(self, now: float) -> RequestedMessage | None:
        """Return the message to request now, or None; call only while no other request is pending."""
        if now < self._due:
            return None
        self._exhausted = {request for request, tries in self._asked.items() if tries >= TRIES}
        request = next((each for each in self._wanted() if each not in self._exhausted), None)
        if request is not None:
            self._asked[request] = self._asked.get(request, 0) + 1
            self._last, self._due = request, now + RETRY_AFTER
        return request

    def handle_refusal(self) -> None:
        """Give up the last request: the vehicle has refused it, or has not answered the command at all."""
        if self._last is not None:
            self._asked[self._last], self._due = TRIES, 0.0

    def _wanted(self) -> list[RequestedMessage]:
        version = [VERSION] if self.version is None else []
        modes = self._mode_requests() if self._wants_modes and self.modes is None else []
        return version + modes + ([METADATA] if self._wants_metadata and self.metadata is None else [])

    def _mode_requests(self) -> list[RequestedMessage]:
        """Return how to request what is missing: all at once, or the lost ones one by one."""
        if self._mode_count is None:
            return [RequestedMessage(m.AvailableModes.id)]
        missing = (index for index in range(1, self._mode_count + 1) if index not in self._modes)
        return [RequestedMessage(m.AvailableModes.id, index) for index in missing]

    def _add_mode(self, message: m.AvailableModes) -> None:
        count, index = message.number_modes, message.mode_index
        if not 1 <= index <= count <= MAX_MODES:
            return
        if count != self._mode_count:
            self._modes.clear()
            self._mode_count = count
        if self._last == RequestedMessage(m.AvailableModes.id, index):
            self._due = 0.0  # the next is requested at once
        self._modes[index] = AvailableMode(
            listed_name(message), message.custom_mode, message.standard_mode, message.properties
        )

    def _forget_modes(self) -> None:
        self._modes.clear()
        self._mode_count = None
        self._asked = {each: tries for each, tries in self._asked.items() if each == VERSION}
