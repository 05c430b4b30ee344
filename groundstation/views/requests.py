"""Views of the requests to the services of vehicles: what runs, and how the last ones ended."""

from __future__ import annotations

import msgspec

from groundstation.views.base import View, ViewRequest


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
    service: str = ""
    """Which service it is for, e.g. "params"; see ServiceIntent.service."""
    waits: str = ""
    """What it waits for, e.g. the operator's hands on a slow line; "" if it goes on."""
    system: int = 0
    """System id of the vehicle; 0: there was none."""
    kept: tuple[str, ...] = ()
    """Parameters that the vehicle keeps as they are."""


class RequestsRequest(ViewRequest, frozen=True):
    """All requests to services."""


class RequestsView(View, frozen=True):
    """All requests to the services of all vehicles."""

    running: tuple[RequestLine, ...]
    ended: tuple[RequestLine, ...]
    """The last requests that have ended, oldest first."""
