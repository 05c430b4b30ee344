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


if TYPE_CHECKING:
    AnyRequest: TypeAlias = ViewRequest
    AnyView: TypeAlias = View
else:
    # msgspec decodes a union of tagged structs, not their base class.
    AnyRequest = Union[tuple(ViewRequest.__subclasses__())]  # noqa: UP007
    AnyView = Union[tuple(View.__subclasses__())]  # noqa: UP007
"""Any of the requests, and any of the views, above."""
