"""AnyIntent: the union of all intents, for the codec between screen and station."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeAlias, Union

from groundstation.intents import (  # noqa: F401 - defines the classes
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

if TYPE_CHECKING:
    AnyIntent: TypeAlias = Intent
else:
    # msgspec decodes a union of tagged structs, not their base class.
    _KINDS = [*Intent.__subclasses__(), *ServiceIntent.__subclasses__()]
    AnyIntent = Union[tuple(each for each in _KINDS if each is not ServiceIntent)]  # noqa: UP007
"""Any of the intents."""
