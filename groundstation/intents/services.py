"""Intents that are requests to the services of a vehicle. Views report by their number how they stand.

A new one is a class here and its row in SERVICE_CALLS (station/services/service_calls.py).
"""

from __future__ import annotations

from groundstation.intents.base import Intent


class ServiceIntent(Intent, frozen=True, tag=False):
    """Base class of the requests."""

    request: int
    """Number by which views report how it stands; see ui/display/request_numbers.py."""
    system: int = 0
    """The vehicle that the operator saw: another one that is selected meanwhile must not get the request.

    0: the selected one."""


class FetchParams(ServiceIntent, frozen=True, tag=True):
    """Fetch all parameters."""

    open_to_all = True


class WriteParams(ServiceIntent, frozen=True, tag=True):
    """Set parameters, one after the other; stops at the first that is not set."""

    changes: tuple[tuple[str, float], ...] = ()
    """Names and values."""


class CompareParams(ServiceIntent, frozen=True, tag=True):
    """Compare the parameters with those of a file."""

    name: str = ""
    """Name of the file. Empty: compare no more."""
    text: str = ""


class StoreParams(ServiceIntent, frozen=True, tag=True):
    """Have the vehicle store all parameters."""


class ResetParams(ServiceIntent, frozen=True, tag=True):
    """Have the vehicle reset all parameters to their defaults."""


class SetMessageRate(ServiceIntent, frozen=True, tag=True):
    """Request a message at a rate."""

    component: int = 1
    message: int = 0
    """Its id."""
    name: str = ""
    rate: float = 0.0
    """Hz; 0: the default of the vehicle, below 0: not at all."""


class RequestMessage(ServiceIntent, frozen=True, tag=True):
    """Request a message once."""

    component: int = 1
    message: int = 0
    """Its id."""
    name: str = ""


class CancelRequest(Intent, frozen=True):
    """Cancel a request; what was set or sent before stays."""

    request: int
