"""SERVICE_CALLS: how each request of the operator is made to the services of a vehicle."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from groundstation.intents.services import FetchParams, RequestMessage, ServiceIntent, SetMessageRate, WriteParams
from groundstation.vehicles.services import VehicleServices


@dataclass(frozen=True, slots=True)
class ServiceCall:
    """How an intent becomes a request."""

    service: str
    """Name of the service, by which screens tell their requests from others: RequestLine.service."""
    what: str
    """What is requested, for the case that there is no vehicle."""
    make: Callable[[VehicleServices, Any, float], None]
    """Called with the services of the vehicle, the intent and the time."""


SERVICE_CALLS: dict[type[ServiceIntent], ServiceCall] = {
    FetchParams: ServiceCall(
        "params", "fetch parameters", lambda services, intent, now: services.params.fetch(intent.request, now)
    ),
    WriteParams: ServiceCall(
        "params",
        "set parameters",
        lambda services, intent, now: services.param_writer.write(intent.request, intent.changes, now),
    ),
    SetMessageRate: ServiceCall(
        "messages",
        "set the rate of a message",
        lambda services, intent, now: services.messages.set_rate(
            intent.request, intent.component, intent.message, intent.name, intent.rate, now
        ),
    ),
    RequestMessage: ServiceCall(
        "messages",
        "request a message",
        lambda services, intent, now: services.messages.request_once(
            intent.request, intent.component, intent.message, intent.name, now
        ),
    ),
}
"""Intent -> call."""
