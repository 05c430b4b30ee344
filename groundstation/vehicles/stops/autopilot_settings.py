"""What the station reads of a foreign vehicle's parameters: one AutopilotSettings for each autopilot."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import msgspec

from groundstation.vehicles.stops.altitude_fence import AltitudeFence

ParamCheck = Callable[[float, int], str | None]
"""Takes the value and our system id; returns a warning that names the remedy, or None."""


class AutopilotSettings(msgspec.Struct, frozen=True):
    """The parameters of one autopilot that decide what it does with our demands, and without us."""

    checks: Mapping[str, ParamCheck]
    """Parameter -> its check."""
    link_loss_action: Callable[[Mapping[str, float]], str | None]
    """Takes the known values; returns what the vehicle does when it loses us, or None if that is not known."""
    former_names: Mapping[str, str] = msgspec.field(default_factory=dict)
    """Parameter -> its name in older versions; a vehicle has one of them. Both are in `checks`."""
    fence: tuple[str, ...] = ()
    """Parameters of the altitude fence. A vehicle without a fence has none of them, and may take off all the same."""
    find_fence: Callable[[Mapping[str, float]], AltitudeFence | None] = lambda values: None
    """Takes the known values; returns the altitude fence, or None if it is off."""
    obeyed: tuple[str, ...] = ()
    """Parameters with the ground station that the vehicle obeys; their warning goes before all others."""
    bytewise: bool = False
    """Integers are stored in the bytes of the float (link/services/param/values.py)."""
    frame: str = ""
    """The parameter that selects the vehicle's axes (dialects.axes.axis_map)."""
