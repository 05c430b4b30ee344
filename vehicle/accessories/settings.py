"""From [accessories] of the file of settings to outputs: what each is, what is wrong with it, and how it is opened."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Annotated, Any, Literal

import msgspec

from link.runtime.toml_errors import explain_error
from vehicle.accessories import LARGEST_RELAY, LARGEST_SERVO, OFF, Accessory
from vehicle.accessories.drivers import DRIVERS, Kind
from vehicle.accessories.output import AccessorySpec, PulseRange, Until
from vehicle.motors import MotorError, MotorSettingsError, UnknownDriverError
from vehicle.motors.drivers import load_driver_class
from vehicle.motors.settings import NoSettings, convert

Width = Annotated[int, msgspec.Meta(ge=500, le=2500, description="microseconds")]


class RelaySettings(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """What every relay has beside its driver's settings."""

    number: Annotated[int, msgspec.Meta(ge=0, le=LARGEST_RELAY)]
    """By which commands and plans name it, from 0 (DO_SET_RELAY)."""
    start: bool = False
    """Its state when the vehicle's program starts: true is on."""
    safe: bool = False
    """Its safe state. A pin that nobody holds is an input: what must be on then hangs on the other contact."""
    until: Until = "stop"
    """How long it keeps what it was given, and is safe then: "end" of the program, killed or not; "stop", also an
    emergency stop; "disarm", also disarming and a failsafe that stops the vehicle."""

    def __post_init__(self) -> None:
        if self.until == "disarm" and self.start != self.safe:
            raise ValueError('start must be as safe where until is "disarm": a vehicle starts disarmed')


class ServoSettings(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """What every servo has beside its driver's settings."""

    number: Annotated[int, msgspec.Meta(ge=1, le=LARGEST_SERVO)]
    """By which commands and plans name it, from 1 (DO_SET_SERVO); not one that a motor has (SERVO_OUTPUT_RAW)."""
    min_us: Width = 1000
    """Shorter pulses are refused."""
    trim_us: Width = 1500
    """Where DO_REPEAT_SERVO comes back to."""
    max_us: Width = 2000
    """Longer pulses are refused."""
    safe: Literal["off", "trim"] = "off"
    """What it gets at the start and when it must be safe: no pulses, which leaves it where it is and without force, or
    pulses of `trim_us`."""
    until: Until = "stop"
    """As of a relay: "end", "stop" or "disarm"."""

    def __post_init__(self) -> None:
        if not self.min_us <= self.trim_us <= self.max_us or self.min_us == self.max_us:
            raise ValueError(f"min {self.min_us} <= trim {self.trim_us} <= max {self.max_us} us must hold")


class Accessories(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Relays and servos beside the motors; without a table there are none."""

    relays: tuple[dict[str, Any], ...] = ()
    servos: tuple[dict[str, Any], ...] = ()


COMMON: dict[Kind, type[RelaySettings] | type[ServoSettings]] = {"relay": RelaySettings, "servo": ServoSettings}


def iter_tables(accessories: Accessories) -> Iterator[tuple[Kind, str, dict[str, Any]]]:
    """Kind, name in the file and table of each."""
    for index, table in enumerate(accessories.relays):
        yield "relay", f"accessories.relays[{index}]", table
    for index, table in enumerate(accessories.servos):
        yield "servo", f"accessories.servos[{index}]", table


def build_specs(accessories: Accessories) -> list[AccessorySpec]:
    """What is in a file that has no problems. Raises UnknownDriverError, MotorSettingsError for one that has."""
    return [build_spec(kind, table) for kind, _, table in iter_tables(accessories)]


def build_spec(kind: Kind, table: Mapping[str, Any]) -> AccessorySpec:
    """One of them. Raises UnknownDriverError, MotorSettingsError."""
    name = table.get("driver")
    if not isinstance(name, str):
        raise UnknownDriverError(f"{kind} driver: missing")
    made_by, own_kind = _driver(kind, name)
    beside, own_table = _split(kind, table)
    common = convert(beside, COMMON[kind])
    own: Any = convert(own_table, own_kind or NoSettings)
    make = made_by if own_kind is None else _with(made_by, own)
    taken, shared = getattr(own, "taken", ()), getattr(own, "shared", {})
    if isinstance(common, RelaySettings):
        return AccessorySpec("relay", common.number, make, name, int(common.start), int(common.safe), common.until,
                      taken=taken, shared=shared)  # fmt: skip
    _must_fit(common, own)
    safe = common.trim_us if common.safe == "trim" else OFF
    pulses = PulseRange(common.min_us, common.trim_us, common.max_us)
    return AccessorySpec("servo", common.number, make, name, safe, safe, common.until, pulses, taken, shared)


def find_problems(accessories: Accessories) -> list[str]:
    """A line for each part of the file that is wrong."""
    found: list[str] = []
    holders: dict[tuple[str, int], str] = {}
    for kind, at, table in iter_tables(accessories):
        here = _problems(kind, at, table)
        if not here:
            first = holders.setdefault((kind, table["number"]), at)
            here = [] if first == at else [f"{at}.number: {table['number']} is {first}'s already"]
        found += here
    return found


def _problems(kind: Kind, at: str, table: Mapping[str, Any]) -> list[str]:
    if not isinstance(table.get("driver"), str):
        return [f"{at}.driver: missing; add it, one of {', '.join(DRIVERS[kind])}, or your own as module:Class"]
    try:
        _, own_kind = _driver(kind, table["driver"])
    except MotorError as error:
        return [f"{at}.driver: {error}"]
    beside, own = _split(kind, table)
    also = ("driver", *COMMON[kind].__struct_fields__)
    found = [_problem(beside, COMMON[kind], at), _problem(own, own_kind or NoSettings, at, also)]
    if any(found):
        return [line for line in found if line]
    try:
        build_spec(kind, table)
    except MotorSettingsError as error:
        return [f"{at}: {error}"]
    return []


def _problem(table: Mapping[str, Any], kind: Any, at: str, also: tuple[str, ...] = ()) -> str | None:
    try:
        msgspec.convert(dict(table), kind)
    except msgspec.ValidationError as error:
        return explain_error(error, kind, at, also)
    return None


def settings_type(kind: Kind, name: str) -> type | None:
    """The msgspec.Struct of a driver's own settings; None where it has none. Raises UnknownDriverError."""
    return _driver(kind, name)[1]


def _driver(kind: Kind, name: str) -> tuple[Any, type | None]:
    found = load_driver_class(name, DRIVERS[kind], f"{kind} driver")
    return found, getattr(found, "Settings", None)


def _split(kind: Kind, table: Mapping[str, Any]) -> tuple[dict[str, Any], dict[str, Any]]:
    keys = COMMON[kind].__struct_fields__
    beside = {key: value for key, value in table.items() if key in keys}
    return beside, {key: value for key, value in table.items() if key not in keys and key != "driver"}


def _with(made_by: Any, own: Any) -> Callable[[int], Accessory]:
    def make(value: int) -> Accessory:
        accessory: Accessory = made_by(own, value)
        return accessory

    return make


def _must_fit(common: ServoSettings, own: Any) -> None:
    """The longest pulse leaves the output low for a while in each period."""
    frequency = getattr(own, "frequency", None)
    if frequency is not None and common.max_us > 0.95e6 / frequency:
        raise MotorSettingsError(f"max_us {common.max_us} does not fit into {frequency:g} Hz, {1e6 / frequency:g} us")
