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


if TYPE_CHECKING:
    AnyRequest: TypeAlias = ViewRequest
    AnyView: TypeAlias = View
else:
    # msgspec decodes a union of tagged structs, not their base class.
    AnyRequest = Union[tuple(ViewRequest.__subclasses__())]  # noqa: UP007
    AnyView = Union[tuple(View.__subclasses__())]  # noqa: UP007
"""Any of the requests, and any of the views, above."""
