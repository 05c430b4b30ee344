"""Views of the parameters of the selected vehicle."""

from __future__ import annotations

import msgspec

from groundstation.views.base import View, ViewRequest
from groundstation.views.requests import RequestLine


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
