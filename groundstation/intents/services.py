"""Intents that are requests to the services of a vehicle. Views report by their number how they stand.

A new one is a class here, which makes the request itself.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from groundstation.intents.base import Intent

if TYPE_CHECKING:
    from groundstation.vehicles.services import VehicleServices


class ServiceIntent(Intent, frozen=True, tag=False):
    """Base class of the requests."""

    service: ClassVar[str] = ""
    """By which screens tell these requests from others: RequestLine.service."""
    what: ClassVar[str] = ""
    """What is requested: for the log, and for the case that there is no vehicle."""

    request: int
    """Number by which views report how it stands; see ui/display/request_numbers.py."""
    system: int = 0
    """The vehicle that the operator saw: another one that is selected meanwhile must not get the request.

    0: the selected one."""

    def start(self, services: VehicleServices, now: float) -> None:
        """Make the request to the services of its vehicle; called in the station."""
        raise NotImplementedError


class FetchParams(ServiceIntent, frozen=True, tag=True):
    """Fetch all parameters."""

    service, what = "params", "fetch parameters"
    open_to_all = True

    def start(self, services: VehicleServices, now: float) -> None:
        services.params.fetch(self.request, now)


class WriteParams(ServiceIntent, frozen=True, tag=True):
    """Set parameters, one after the other; stops at the first that is not set."""

    service, what = "params", "set parameters"

    changes: tuple[tuple[str, float], ...] = ()
    """Names and values."""

    def start(self, services: VehicleServices, now: float) -> None:
        services.param_writer.write(self.request, self.changes, now)


class CompareParams(ServiceIntent, frozen=True, tag=True):
    """Compare the parameters with those of a file."""

    service, what = "params", "compare parameters"

    name: str = ""
    """Name of the file. Empty: compare no more."""
    text: str = ""

    def start(self, services: VehicleServices, now: float) -> None:
        services.param_file.open(self.request, self.name, self.text, now)


class StoreParams(ServiceIntent, frozen=True, tag=True):
    """Have the vehicle store all parameters."""

    service, what = "params", "store parameters"

    def start(self, services: VehicleServices, now: float) -> None:
        services.param_storage.store(self.request, now)


class ResetParams(ServiceIntent, frozen=True, tag=True):
    """Have the vehicle reset all parameters to their defaults."""

    service, what = "params", "reset parameters"

    def start(self, services: VehicleServices, now: float) -> None:
        services.param_storage.reset(self.request, now)


class SetMessageRate(ServiceIntent, frozen=True, tag=True):
    """Request a message at a rate."""

    service, what = "messages", "set the rate of a message"

    component: int = 1
    message: int = 0
    """Its id."""
    name: str = ""
    rate: float = 0.0
    """Hz; 0: the default of the vehicle, below 0: not at all."""

    def start(self, services: VehicleServices, now: float) -> None:
        services.messages.set_rate(self.request, self.component, self.message, self.name, self.rate, now)


class RequestMessage(ServiceIntent, frozen=True, tag=True):
    """Request a message once."""

    service, what = "messages", "request a message"

    component: int = 1
    message: int = 0
    """Its id."""
    name: str = ""

    def start(self, services: VehicleServices, now: float) -> None:
        services.messages.request_once(self.request, self.component, self.message, self.name, now)


class CancelRequest(Intent, frozen=True):
    """Cancel a request; what was set or sent before stays."""

    request: int
