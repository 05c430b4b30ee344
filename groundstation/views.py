"""Views: what a screen requests while it is shown, beside the snapshot. Nothing is sent for screens that are hidden.

A screen lists its requests (intent Watch); the station answers each with views, at the rate of its source, when they
have changed. Only the newest view of a kind counts. A new view is a request and a view here, and a row in
Station.views (station/station.py).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeAlias, Union

import msgspec

from groundstation.snapshot import LogLine


class ViewRequest(msgspec.Struct, frozen=True, tag=True):
    """Base class of all requests."""


class View(msgspec.Struct, frozen=True, tag=True):
    """Base class of all views."""


class LogRequest(ViewRequest, frozen=True):
    """Lines of the message log."""

    after: int = 0
    """Lines that are new, or were counted again, since this state of the log: LogPage.state of the newest page."""


class LogPage(View, frozen=True):
    """Lines of the message log, oldest first; at most message_log.PAGE of them."""

    lines: tuple[LogLine, ...]
    state: int
    """State of the log after these lines. A screen that requests the lines after it loses none and gets none twice."""
    after: int = 0
    """That of the request: a page for the screen that was open before must not pass for an answer to this one."""


class VehiclesRequest(ViewRequest, frozen=True):
    """All vehicles."""


class ComponentRow(msgspec.Struct, frozen=True):
    """A further component of a vehicle, such as a camera."""

    component: int
    kind: str
    """Its MAV_TYPE in words, e.g. "onboard controller"."""


class VehicleRow(msgspec.Struct, frozen=True, kw_only=True):
    """One vehicle. Ages and distances are rounded to what is drawn, so that an unchanged row is not sent again."""

    system: int
    name: str
    firmware: str = ""
    """Version, e.g. "4.6.1"; empty until AUTOPILOT_VERSION has arrived."""
    mode: str
    armed: bool
    emergency_stop: bool = False
    alive: bool = True
    silence: float
    """Seconds since the last message."""
    state: str = ""
    """MAV_STATE in words."""
    battery_voltage: float | None = None
    battery_remaining: float | None = None
    """0..1"""
    distance: float | None = None
    """m from the selected vehicle; of the selected vehicle itself from its home. None: not known."""
    bearing: float | None = None
    """Degrees clockwise from north, seen from there."""
    has_position: bool = False
    in_control: bool = False
    """This station is in control."""
    driver: int | None = None
    """System id of the ground station in control, 0 for none; None if the vehicle does not report it."""
    components: tuple[ComponentRow, ...] = ()


class VehiclesView(View, frozen=True):
    """All vehicles, by system id."""

    rows: tuple[VehicleRow, ...]
    not_shown: int = 0
    """Further vehicles that are heard, for which there is no place."""


class LinksRequest(ViewRequest, frozen=True):
    """All links."""


class LinkRow(msgspec.Struct, frozen=True, kw_only=True):
    """One link. Rates are over the last 5 s, counters since the link opened."""

    name: str
    """The endpoint as the user wrote it."""
    peers: tuple[str, ...] = ()
    """Addresses of the first other ends that sent a HEARTBEAT, without one that the endpoint names."""
    peer_count: int = 0
    """Other ends that sent a HEARTBEAT."""
    frames_in: float = 0.0
    """Frames received per second."""
    frames_out: float = 0.0
    bytes_in: float = 0.0
    """Bytes received per second."""
    bytes_out: float = 0.0
    loss: float | None = None
    """Lost fraction of the frames of vehicles; None if none arrived."""
    lost: int = 0
    """Frames of vehicles that were lost."""
    crc_errors: int = 0
    refused: int = 0
    """Peers refused because there was no place."""
    dropped: int = 0
    """Frames that could not be sent."""
    round_trip: float | None = None
    """s, on the link of the selected vehicle."""
    jitter: float | None = None
    """s; smoothed difference between one round trip and the next."""
    capacity: float | None = None
    """Bytes/s that the line carries in each direction; None where unknown (UDP, TCP)."""
    headroom: float = 1.0
    """Share of the capacity that a telemetry radio allows now."""
    problem: str | None = None

    @property
    def share(self) -> float | None:
        """Share of the capacity that the busier direction uses; None where the capacity is unknown."""
        return None if not self.capacity else max(self.bytes_in, self.bytes_out) / self.capacity


class LinksView(View, frozen=True):
    """All links, in the order of the command line."""

    rows: tuple[LinkRow, ...]


class ControlRequest(ViewRequest, frozen=True):
    """Who is in control of the selected vehicle."""


class Program(msgspec.Struct, frozen=True):
    """A program that controls vehicles: a ground station or a script."""

    system: int
    component: int
    session: int = 0
    """Its random number; 0: it has none."""


class StationRow(msgspec.Struct, frozen=True):
    """A ground station that is heard."""

    system: int
    component: int
    silence: float
    """Seconds since its last HEARTBEAT."""


class ControlView(View, frozen=True, kw_only=True):
    """Who is in control of the selected vehicle, as it reports, and who else is there."""

    vehicle: str
    """Its name; empty without a vehicle."""
    ours: Program
    """This station."""
    in_control: bool = False
    """This station is in control."""
    driver: int | None = None
    """System id of the ground station in control, 0 for none; None if the vehicle does not report it."""
    program: Program | None = None
    """Its program in ROVER_CONTROL; None if the vehicle sends none, or no program is in control."""
    age: float | None = None
    """Seconds since the vehicle reported it."""
    takeover: bool = False
    """A request for control is granted without asking the driver."""
    clash: bool = False
    """Two programs send with the ids of the driver: its demands do not count for the moment."""
    silent: bool = False
    """The driver is silent: another program with its ids may succeed it."""
    waits: float | None = None
    """Seconds for which the driver may still answer our request."""
    stations: tuple[StationRow, ...] = ()
    """Other ground stations, by their ids."""
    signs: bool = False
    """The vehicle signs its frames."""
    signing: tuple[int, ...] = ()
    """All system ids whose newest frame was signed."""


class ParamPageRequest(ViewRequest, frozen=True):
    """Parameters of the selected vehicle, sorted by name."""

    filter: str = ""
    """Words, one of which must be in the name; upper or lower case. Empty: all."""
    changed_only: bool = False
    """Only those that are not at their default."""
    first: int = 0
    """First row, counted among those that match."""
    rows: int = 0


class ParamRow(msgspec.Struct, frozen=True):
    """One parameter."""

    name: str
    value: float
    kind: str
    """Name of its MAV_PARAM_TYPE, e.g. "INT8"."""
    default: float | None
    """None: not known."""
    changed: bool
    """It is not at its default."""


class RequestLine(msgspec.Struct, frozen=True):
    """A request to the vehicle that runs or has ended."""

    number: int
    """As in the intent that made it."""
    state: str
    """"running", "accepted", "refused", "no answer" or "cancelled"."""
    what: str
    """What was requested, e.g. "fetch parameters"."""
    detail: str = ""
    """Why it was refused, or what came of it."""
    done: int = 0
    total: int | None = None


class ParamPage(View, frozen=True):
    """A page of parameters."""

    system: int
    """System id of the vehicle."""
    rows: tuple[ParamRow, ...]
    first: int
    """Number of the first row: less than requested if there are fewer that match."""
    matching: int
    known: int
    total: int | None
    """Parameters that the vehicle has; None: not known."""
    has_defaults: bool
    running: tuple[RequestLine, ...]
    ended: tuple[RequestLine, ...]
    """The last requests that have ended, oldest first."""


class MessagesRequest(ViewRequest, frozen=True):
    """Rows of the Messages screen: sources, and the messages of each."""

    order: str = "source"
    """One of MESSAGE_ORDERS. "source" is a tree; in the other orders rows of all sources stand in one list."""
    text: str = ""
    """Filter: words that all must match; see station/message_filter.py."""
    first: int = 0
    """Index of the first row wanted; more than there are means the last ones."""
    count: int = 50
    """Number of rows wanted."""
    closed: tuple[tuple[int, int, bool], ...] = ()
    """Sources whose messages are not listed: system, component, sent."""


MESSAGE_ORDERS = ("source", "name", "rate", "bytes", "age")
"""Orders of the Messages screen."""


class MessageRow(msgspec.Struct, frozen=True):
    """A source, or one of its messages."""

    system: int
    component: int
    sent: bool
    """This station sends it."""
    name: str
    """Name of the message; "" for the source itself."""
    rate: float
    """Messages/s."""
    bytes: float
    """Bytes/s: the rate times the length of the newest frame, as MAVLink 2 without a signature."""
    count: int
    age: float
    """s since the newest one."""
    label: str = ""
    """What the source is."""
    loss: float | None = None
    """Share of the frames of the source that were lost, 0..1; None for messages and for what is sent."""
    lost: int = 0
    unknown: bool = False
    """Its id is in no dialect that the station knows: the name is "#" and the id, the label the length of a frame."""


class MessagesPage(View, frozen=True):
    """Rows of the Messages screen."""

    rows: tuple[MessageRow, ...]
    first: int
    """Index of the first of them in the list."""
    total: int
    """Rows in the list."""
    kinds: int
    """Kinds of messages before the filter."""
    rate: float
    bytes: float
    """Of all messages, received and sent."""
    not_shown: int = 0
    """Messages of sources for which the table has no place."""
    order: str = "source"
    text: str = ""
    """Those of the request: a page for another filter must not pass for the answer to this one."""


class MessageRequest(ViewRequest, frozen=True):
    """The newest message of a kind."""

    system: int
    component: int
    sent: bool
    name: str


class MessageField(msgspec.Struct, frozen=True, array_like=True):
    """A field of a message, as texts."""

    name: str
    value: str
    unit: str
    meaning: str = ""
    """The name of an enum value, or the value in a usual unit."""
    flags: tuple[str, ...] = ()
    """Names of the bits of a bitmask that are set."""


class MessageView(View, frozen=True):
    """The newest message of a kind."""

    system: int
    component: int
    sent: bool
    name: str
    id: int
    rate: float
    count: int
    age: float
    """s since it was received or sent."""
    length: int
    """Bytes of its frame."""
    fields: tuple[MessageField, ...]
    """None for an id that is in no dialect that the station knows."""


if TYPE_CHECKING:
    AnyRequest: TypeAlias = ViewRequest
    AnyView: TypeAlias = View
else:
    # msgspec decodes a union of tagged structs, not their base class.
    AnyRequest = Union[tuple(ViewRequest.__subclasses__())]  # noqa: UP007
    AnyView = Union[tuple(View.__subclasses__())]  # noqa: UP007
"""Any of the requests, and any of the views, above."""
