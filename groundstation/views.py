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


if TYPE_CHECKING:
    AnyRequest: TypeAlias = ViewRequest
    AnyView: TypeAlias = View
else:
    # msgspec decodes a union of tagged structs, not their base class.
    AnyRequest = Union[tuple(ViewRequest.__subclasses__())]  # noqa: UP007
    AnyView = Union[tuple(View.__subclasses__())]  # noqa: UP007
"""Any of the requests, and any of the views, above."""
