"""Settings of accessories: checking [accessories] of the configuration file, and building specifications from it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Annotated, Any, Literal

import msgspec

from link.toml.errors import explain_errors
from vehicle.accessories import LARGEST_RELAY, LARGEST_SERVO, OFF, Accessory
from vehicle.accessories.drivers import DRIVERS, AccessoryKind
from vehicle.accessories.output import AccessorySpec, PulseRange, Until
from vehicle.motors import MotorError, MotorSettingsError, UnknownDriverError
from vehicle.motors.drivers import load_driver_class
from vehicle.motors.settings import NoSettings, convert

Width = Annotated[int, msgspec.Meta(ge=500, le=2500, description="microseconds")]


class RelaySettings(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Settings that every relay has beside its driver's."""

    number: Annotated[int, msgspec.Meta(ge=0, le=LARGEST_RELAY)]
    """Number in commands and missions, from 0 (DO_SET_RELAY)."""
    start: bool = False
    """State when the vehicle program starts: true is on."""
    safe: bool = False
    """Safe state. A pin becomes an input when the program ends: wire a load that must be on then to the other
    contact."""
    until: Until = "stop"
    """When the relay returns to its safe state: "end" of the program, killed or not; "stop", also at an emergency stop;
    "disarm", also when disarmed or stopped by a failsafe."""

    def __post_init__(self) -> None:
        if self.until == "disarm" and self.start != self.safe:
            raise ValueError('start must equal safe if until is "disarm": a vehicle starts disarmed')


class ServoSettings(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Settings that every servo has beside its driver's."""

    number: Annotated[int, msgspec.Meta(ge=1, le=LARGEST_SERVO)]
    """Number in commands and missions, from 1 (DO_SET_SERVO); not the number of a motor (SERVO_OUTPUT_RAW)."""
    min_us: Width = 1000
    """Shorter pulses are rejected."""
    trim_us: Width = 1500
    """Position to which DO_REPEAT_SERVO returns."""
    max_us: Width = 2000
    """Longer pulses are rejected."""
    safe: Literal["off", "trim"] = "off"
    """Output at the start and when the servo must be safe: "off" for no pulses, which leaves the servo in place without
    torque, or "trim" for pulses of `trim_us`."""
    until: Until = "stop"
    """When the servo returns to its safe output, as for a relay: "end", "stop" or "disarm"."""

    def __post_init__(self) -> None:
        if not self.min_us <= self.trim_us <= self.max_us or self.min_us == self.max_us:
            raise ValueError(f"min {self.min_us} <= trim {self.trim_us} <= max {self.max_us} us must hold")


class Accessories(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Relays and servos beside the motors; there are none without a table."""

    relays: tuple[dict[str, Any], ...] = ()
    servos: tuple[dict[str, Any], ...] = ()


COMMON: dict[AccessoryKind, type[RelaySettings] | type[ServoSettings]] = {
    "relay": RelaySettings,
    "servo": ServoSettings,
}


def iter_tables(accessories: Accessories) -> Iterator[tuple[AccessoryKind, str, dict[str, Any]]]:
    """Yield kind, name in the file and table of each accessory."""
    for index, table in enumerate(accessories.relays):
        yield "relay", f"accessories.relays[{index}]", table
    for index, table in enumerate(accessories.servos):
        yield "servo", f"accessories.servos[{index}]", table


def build_specs(accessories: Accessories) -> list[AccessorySpec]:
    """Return the specifications of all accessories. Raises UnknownDriverError, MotorSettingsError."""
    return [build_spec(kind, table) for kind, _, table in iter_tables(accessories)]


def build_spec(kind: AccessoryKind, table: Mapping[str, Any]) -> AccessorySpec:
    """Return the specification of one accessory. Raises UnknownDriverError, MotorSettingsError."""
    name = table.get("driver")
    if not isinstance(name, str):
        raise UnknownDriverError(f"{kind} driver: missing")
    driver, own_kind = _load_driver(kind, name)
    common_table, own_table = _split(kind, table)
    common = convert(common_table, COMMON[kind])
    own: Any = convert(own_table, own_kind or NoSettings)
    make = driver if own_kind is None else _with_settings(driver, own)
    taken, shared = getattr(own, "taken", ()), getattr(own, "shared", {})
    if isinstance(common, RelaySettings):
        return AccessorySpec("relay", common.number, make, name, int(common.start), int(common.safe), common.until,
                      taken=taken, shared=shared)  # fmt: skip
    _check_period(common, own)
    safe = common.trim_us if common.safe == "trim" else OFF
    pulses = PulseRange(common.min_us, common.trim_us, common.max_us)
    return AccessorySpec("servo", common.number, make, name, safe, safe, common.until, pulses, taken, shared)


def find_problems(accessories: Accessories) -> list[str]:
    """Return one line for each error in the tables."""
    problems: list[str] = []
    owners: dict[tuple[str, int], str] = {}
    for kind, at, table in iter_tables(accessories):
        found = _problems(kind, at, table)
        if not found:
            first = owners.setdefault((kind, table["number"]), at)
            found = [] if first == at else [f"{at}.number: {table['number']} is already used by {first}"]
        problems += found
    return problems


def _problems(kind: AccessoryKind, at: str, table: Mapping[str, Any]) -> list[str]:
    if not isinstance(table.get("driver"), str):
        return [f"{at}.driver: missing; add it, one of {', '.join(DRIVERS[kind])}, or your own as module:Class"]
    try:
        _, own_kind = _load_driver(kind, table["driver"])
    except MotorError as error:
        return [f"{at}.driver: {error}"]
    common, own = _split(kind, table)
    other_keys = ("driver", *COMMON[kind].__struct_fields__)
    found = explain_errors(dict(common), COMMON[kind], at)
    found += explain_errors(dict(own), own_kind or NoSettings, at, other_keys)
    if found:
        return found
    try:
        build_spec(kind, table)
    except MotorSettingsError as error:
        return [f"{at}: {error}"]
    return []


def settings_type(kind: AccessoryKind, name: str) -> type | None:
    """Return the msgspec.Struct of a driver's own settings, None without any. Raises UnknownDriverError."""
    return _load_driver(kind, name)[1]


def _load_driver(kind: AccessoryKind, name: str) -> tuple[Any, type | None]:
    driver = load_driver_class(name, DRIVERS[kind], f"{kind} driver")
    return driver, getattr(driver, "Settings", None)


def _split(kind: AccessoryKind, table: Mapping[str, Any]) -> tuple[dict[str, Any], dict[str, Any]]:
    keys = COMMON[kind].__struct_fields__
    common = {key: value for key, value in table.items() if key in keys}
    return common, {key: value for key, value in table.items() if key not in keys and key != "driver"}


def _with_settings(driver: Any, own: Any) -> Callable[[int], Accessory]:
    def make(value: int) -> Accessory:
        accessory: Accessory = driver(own, value)
        return accessory

    return make


def _check_period(common: ServoSettings, own: Any) -> None:
    """Raise MotorSettingsError if the longest pulse fills its period, so that the output would never be low."""
    frequency = getattr(own, "frequency", None)
    if frequency is not None and common.max_us > 0.95e6 / frequency:
        raise MotorSettingsError(f"max_us {common.max_us} does not fit into {frequency:g} Hz, {1e6 / frequency:g} us")
