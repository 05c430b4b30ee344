"""Base classes of the requests and the views."""

from __future__ import annotations

import msgspec


class ViewRequest(msgspec.Struct, frozen=True, tag=True):
    """Base class of all requests."""


class View(msgspec.Struct, frozen=True, tag=True):
    """Base class of all views."""
