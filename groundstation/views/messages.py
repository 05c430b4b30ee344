"""Views of the messages: their rates, and the fields of one of them."""

from __future__ import annotations

import msgspec

from groundstation.views.base import View, ViewRequest
from groundstation.views.charts import FieldInfo


class MessagesRequest(ViewRequest, frozen=True):
    """Rows of the Messages screen: sources, and the messages of each."""

    order: str = "source"
    """One of MESSAGE_ORDERS. "source" is a tree; in the other orders rows of all sources stand in one list."""
    text: str = ""
    """Filter: words that all must match; see station/messages/message_filter.py."""
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
    """Frames that were lost of the source, also in the rows of its messages."""
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
    history: tuple[int, ...] = ()
    """Bytes/s of all links in the last minute, the oldest first, one a second."""


class MessageRequest(ViewRequest, frozen=True):
    """The newest message of a kind."""

    system: int
    component: int
    sent: bool
    name: str
    field: str = ""
    """The field whose last minute is wanted; "": none."""
    index: int = 0
    """Item of it, where it is an array."""


class MessageField(msgspec.Struct, frozen=True, array_like=True):
    """A field of a message, as texts."""

    name: str
    value: str
    unit: str
    meaning: str = ""
    """The name of an enum value, or the value in a usual unit."""
    flags: tuple[str, ...] = ()
    """Names of the bits of a bitmask that are set."""
    spark: str = ""
    """Up to nine bars: what the value was in the last minute."""


class FieldPlot(msgspec.Struct, frozen=True):
    """The last minute of one field."""

    info: FieldInfo
    now: float
    """s of the station's clock."""
    times: bytes
    """By the same clock, as 8-byte floats of this machine."""
    values: bytes
    """In the unit of `info`, as 8-byte floats of this machine."""


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
    payload: bytes = b""
    """Without its trailing zeros, as MAVLink 2 sends it."""
    plot: FieldPlot | None = None


class CaptureRequest(ViewRequest, frozen=True):
    """Every message of a kind as a line of CSV."""

    system: int
    component: int
    sent: bool
    name: str
    after: int = 0
    """Lines after this state: CapturePage.state of the newest page."""


class CapturePage(View, frozen=True):
    """Lines of CSV, oldest first."""

    titles: str
    lines: tuple[str, ...]
    state: int
    """State after these lines. A screen that requests those after it gets none twice."""
    after: int
    """That of the request."""
    lost: int = 0
    """Messages before them for which there was no room."""
