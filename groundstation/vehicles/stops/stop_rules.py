"""What the rules of all autopilots share: the facts about one vehicle, and how a bound is put together.

"What stops it, and when" is said by the vehicle's own parameters. What was not read, or is not known of a kind of
vehicle, has no bound; nothing is assumed.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import msgspec

from dialects.enums import VehicleType
from groundstation.snapshot.drive import StopBound


class StopFacts(msgspec.Struct, frozen=True):
    """What is known of a vehicle. Times in s."""

    params: Mapping[str, float] = msgspec.field(default_factory=dict)
    """Parameters that were read."""
    kind: int = VehicleType.GROUND_ROVER
    """MAV_TYPE."""
    drives_itself: bool = False
    """Armed in an autonomous mode: the keys do not drive it, and their loss does not stop it."""
    command_age: float | None = None
    """Age of the demand that it obeys."""
    estimated: bool = False
    """The age is an estimate of this station."""
    quiet: float | None = None
    """For how long it may have received nothing from us."""
    manual_timeout: float | None = None
    """MAN_TIMEOUT as in ROVER_DRIVE_INFO, of our own vehicle."""
    input_age: float | None = None
    """Age of the newest key event, while a demand moves the vehicle."""
    voltage: float | None = None
    tilt: float | None = None
    """The larger one of roll and pitch, degrees."""

    def value(self, name: str) -> float | None:
        """Return a parameter; None while it is not known."""
        return self.params.get(name)

    def sum(self, *terms: float | str) -> float | None:
        """Return the sum of numbers and parameters; None while one of them is not known."""
        values = [self.params.get(term) if isinstance(term, str) else term for term in terms]
        return None if None in values else sum(value for value in values if value is not None)


StopRule = Callable[[StopFacts], StopBound]


class StopRules(msgspec.Struct, frozen=True):
    """The rules of one autopilot, most important first, and the parameters that they read."""

    rules: tuple[StopRule, ...]
    params: tuple[str, ...]


def is_off(value: float | None) -> bool:
    """Return whether a parameter that selects an action is known to select none."""
    return value is not None and int(value) == 0


def action_bound(
    name: str, source: str, bound: float | None, action: str | None, value: float | None, *, estimated: bool = False
) -> StopBound:
    """Return the bound of an action; "" is known to be none, None is not known."""
    if action == "":
        return StopBound(name, "nothing", source, never=True)
    return StopBound(name, action or "--", source, bound, value, estimated=estimated)
