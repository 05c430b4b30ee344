"""AnyIntent: the union of all intents, for the codec between screen and station."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeAlias, Union

from groundstation.intents import (  # noqa: F401 - defines the classes
    agents,
    charts,
    driving,
    files,
    line,
    links,
    plan,
    replay,
    services,
    session,
    setup,
    vehicle,
    watch,
)
from groundstation.intents.base import Intent
from groundstation.intents.services import ServiceIntent
from groundstation.intents.vehicle_intent import VehicleIntent

if TYPE_CHECKING:
    AnyIntent: TypeAlias = Intent
else:
    # msgspec decodes a union of tagged structs, not their base class.
    _BASES = (ServiceIntent, VehicleIntent)
    _KINDS = [kind for base in (Intent, *_BASES) for kind in base.__subclasses__() if kind not in _BASES]
    AnyIntent = Union[tuple(_KINDS)]  # noqa: UP007
"""Any of the intents."""
