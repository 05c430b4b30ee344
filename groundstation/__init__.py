"""Terminal ground station and its command line, and `Rover` for Python programs (groundstation/rover/)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from groundstation.rover import AsyncRover as AsyncRover
    from groundstation.rover import Fence as Fence
    from groundstation.rover import Mission as Mission
    from groundstation.rover import Rally as Rally
    from groundstation.rover import Rover as Rover

_OF_PROGRAMS = ("AsyncRover", "Fence", "Mission", "Rally", "Rover")


def __getattr__(name: str) -> Any:
    """Import what programs use when they ask for it: the screen and the verbs do without."""
    if name not in _OF_PROGRAMS:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from groundstation import rover

    return getattr(rover, name)
