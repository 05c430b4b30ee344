"""Details of one vehicle that the snapshot lacks: components, place on earth, track, firmware, takeover."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from dialects import messages as m
from dialects.enums import ControlFlag, type_name
from groundstation.geo import LocalFrame, Place, is_on_earth
from groundstation.vehicles.readings.track import Track
from groundstation.views.links import ComponentRow
from link.core import Received

MAX_COMPONENTS = 16
"""Component ids kept for a vehicle; a flood of invented ones must not grow a table."""

COMPONENT_TIMEOUT = 10.0
"""s without a HEARTBEAT after which a component is not listed any more."""

TAKEOVER_ALLOWED = 2
"""GCS_CONTROL_STATUS_FLAGS of CONTROL_STATUS."""


class VehicleDetails:
    """Collects the details from the messages of one system. `component` is the one that the station talks to."""

    def __init__(self, component: int) -> None:
        self.place: Place | None = None
        self.home: Place | None = None
        self.origin: Place | None = None
        """From where `track` counts: the first place. VehicleState.trail needs none, it is in the vehicle's frame."""
        self.track = Track()
        self.firmware = ""
        """Version of AUTOPILOT_VERSION, e.g. "4.6.1"; empty until it has arrived."""
        self.takeover = False
        """A request for control is granted without asking the driver."""
        self.control_at: float | None = None
        """When the vehicle reported last who is in control."""
        self._component = component
        self._components: dict[int, tuple[str, float]] = {}
        """Component id -> its kind in words, and when its HEARTBEAT arrived."""

    def receive(self, received: Received, now: float) -> None:
        """Handle a message of the system."""
        message = received.message
        if isinstance(message, m.Heartbeat) and received.component != self._component:
            self._add_component(received.component, message.type, now)
        method = _HANDLERS.get(type(message))
        if method is not None and received.component == self._component:
            method(self, message, now)

    def components(self, now: float) -> tuple[ComponentRow, ...]:
        """Return the further components that are heard, by id."""
        heard = ((number, kind) for number, (kind, at) in self._components.items() if now - at <= COMPONENT_TIMEOUT)
        return tuple(ComponentRow(number, kind) for number, kind in sorted(heard))

    def _add_component(self, component: int, kind: int, now: float) -> None:
        if component in self._components or len(self._components) < MAX_COMPONENTS:
            self._components[component] = (type_name(kind), now)

    def _global_position(self, message: m.GlobalPositionInt, now: float) -> None:
        place = to_place(message.lat, message.lon)
        if place is not None:
            self.place, self.origin = place, self.origin or place
            self.track.add(LocalFrame(self.origin).to_point(place))

    def _home(self, message: m.HomePosition, now: float) -> None:
        self.home = to_place(message.latitude, message.longitude) or self.home

    def _version(self, message: m.AutopilotVersion, now: float) -> None:
        number = message.flight_sw_version
        self.firmware = f"{number >> 24}.{number >> 16 & 0xFF}.{number >> 8 & 0xFF}" if number else ""

    def _control_status(self, message: m.ControlStatus, now: float) -> None:
        self.takeover, self.control_at = bool(message.flags & TAKEOVER_ALLOWED), now

    def _rover_control(self, message: m.RoverControl, now: float) -> None:
        self.takeover, self.control_at = bool(message.flags & ControlFlag.TAKEOVER_ALLOWED), now


_HANDLERS: Mapping[type[m.Message], Callable[[VehicleDetails, Any, float], None]] = {
    m.GlobalPositionInt: VehicleDetails._global_position,
    m.HomePosition: VehicleDetails._home,
    m.AutopilotVersion: VehicleDetails._version,
    m.ControlStatus: VehicleDetails._control_status,
    m.RoverControl: VehicleDetails._rover_control,
}
"""Message -> the method that handles it."""


def to_place(latitude: int, longitude: int) -> Place | None:
    """Return a place from degrees times 10^7; None for 0, 0, which means no fix yet, and for what is not on earth."""
    place = Place(latitude / 1e7, longitude / 1e7)
    if place == (0.0, 0.0) or not is_on_earth(*place):
        return None
    return place
