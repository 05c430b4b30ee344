"""The file of settings, rover.toml: read, checked and explained; what a driver or sensor makes of its part is theirs.

To add a key: a field here, with a docstring, which is its help in the sample (template.py) and the schema (schema.py).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Annotated, Any, get_type_hints

import msgspec

from link.endpoint import EndpointError, parse_endpoint
from link.runtime.toml_errors import explain_error, suggest
from link.runtime.toml_file import TomlError, find_unsupported, parse_toml, read_toml
from vehicle.accessories import settings as accessory_settings
from vehicle.accessories.settings import Accessories
from vehicle.config.conflicts import find_conflicts
from vehicle.motors import MotorError, UnknownDriverError
from vehicle.motors.drivers import DRIVERS, profile_params, profile_settings, settings_type
from vehicle.motors.settings import CommonMotorSettings, NoSettings
from vehicle.params import PARAMETERS, ParamError, Params
from vehicle.sensors.suite import SensorSettings

DEFAULT_FILE = "rover.toml"


class ConfigError(Exception):
    """A file of settings cannot be used. Each of `problems` is one line: file, key, what is wrong, what to do."""

    def __init__(self, *problems: str) -> None:
        more = f" (and {len(problems) - 1} more, see `vehicle check`)" if len(problems) > 1 else ""
        super().__init__(problems[0] + more)
        self.problems = problems


class Identity(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Who this vehicle is."""

    system: Annotated[int, msgspec.Meta(ge=1, le=255)] | None = None
    """MAVLink system id; without it the parameter MAV_SYSID, which is 1 until it is set."""


class LogSettings(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """What is written down. The brief log always goes to stderr, and in a service to the journal."""

    file: str | None = None
    """Append the log here, with times and tracebacks."""
    verbose: bool = False
    """Log more."""
    motors: str | None = None
    """Append each change of the motors here: CLOCK_MONOTONIC ns and the throttles."""
    tlog: str | None = None
    """Folder for the telemetry log of each drive; without it `logs` in the folder of `state`."""


class Config(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The whole file."""

    endpoints: tuple[str, ...] = ()
    """Links to ground stations. Whoever reaches one can ask for control: open them only to networks that you trust."""
    state: str | None = None
    """Folder that keeps what ground stations set; without it the service's own, or one in your home."""
    identity: Identity = Identity()
    motors: dict[str, Any] = {}
    accessories: Accessories = Accessories()
    sensors: SensorSettings = SensorSettings()
    params: dict[str, float] = {}
    log: LogSettings = LogSettings()


def load(path: str | Path) -> Config:
    """The settings of a file. Raises ConfigError."""
    try:
        return _understood(read_toml(path), str(path))
    except TomlError as error:
        absent = isinstance(error.__cause__, FileNotFoundError)
        hint = f"; `vehicle init {path}` writes one to begin with" if absent else ""
        raise ConfigError(f"{error}{hint}") from error


def parse_config(text: str, name: str) -> Config:
    """The settings of a file's text. Raises ConfigError."""
    try:
        return _understood(parse_toml(text, name), name)
    except TomlError as error:
        raise ConfigError(str(error)) from error


def _understood(table: Mapping[str, Any], name: str) -> Config:
    problems = [f"{name}: {problem}" for problem in list(find_unsupported(table)) or _problems(table)]
    if problems:
        raise ConfigError(*problems)
    return msgspec.convert(table, Config)


def _problems(table: Mapping[str, Any]) -> list[str]:
    """One for each section that has any, as far as the sections after it can be judged; all of [params]."""
    kinds = get_type_hints(Config, include_extras=True) | {"params": dict[str, Any]}
    problems: list[str] = []
    for key, value in table.items():
        if key not in kinds:
            problems.append(f"{key}: unknown key; {suggest(key, kinds)}")
            continue
        try:
            msgspec.convert(value, kinds[key])
        except msgspec.ValidationError as error:
            problems.append(explain_error(error, kinds[key], key))
        else:
            problems += _CHECKS[key](value) if key in _CHECKS else []
    return problems or _contradictions(table)


def _endpoint_problems(endpoints: list[str]) -> list[str]:
    problems = []
    for index, text in enumerate(endpoints):
        try:
            parse_endpoint(text)
        except EndpointError as error:
            problems.append(f"endpoints[{index}]: {error}")
    return problems


def _motor_problems(table: Mapping[str, Any]) -> list[str]:
    if not isinstance(table.get("driver"), str):
        return [f"motors.driver: missing; add it, one of {', '.join(DRIVERS)}, or your own as module:Class"]
    name = table["driver"]
    try:
        kind = settings_type(name)
    except UnknownDriverError as error:
        return [f"motors.driver: {error}"]
    except MotorError:  # its library is missing: no mistake in the file, and said when the driver is opened
        return []
    settings = {**profile_settings(name), **{key: value for key, value in table.items() if key != "driver"}}
    beside = {key: value for key, value in settings.items() if key in CommonMotorSettings.__struct_fields__}
    own = {key: value for key, value in settings.items() if key not in beside}
    return _problem(beside, CommonMotorSettings) + _problem(
        own, kind or NoSettings, CommonMotorSettings.__struct_fields__
    )


def _problem(table: Mapping[str, Any], kind: Any, also: tuple[str, ...] = ()) -> list[str]:
    try:
        msgspec.convert(dict(table), kind)
    except msgspec.ValidationError as error:
        return [explain_error(error, kind, "motors", also)]
    return []


def _param_problems(table: Mapping[str, Any]) -> list[str]:
    found = ((name, _param_problem(name, value)) for name, value in table.items())
    return [f"params.{name}: {problem}" for name, problem in found if problem]


def _param_problem(name: str, value: Any) -> str | None:
    if name not in PARAMETERS:
        return f"unknown parameter; {suggest(name.upper(), PARAMETERS)}"
    if isinstance(value, bool) or not isinstance(value, int | float):
        return "must be a number"
    try:
        Params({name: value})
    except ParamError as error:
        return str(error).removeprefix(f"{name} ")
    return None


def _contradictions(table: Mapping[str, Any]) -> list[str]:
    if "system" in table.get("identity", {}) and "MAV_SYSID" in table.get("params", {}):
        return ["params.MAV_SYSID: identity.system says the same thing; keep one of them"]
    usual = profile_params(table.get("motors", {}).get("driver", ""))
    try:
        Params({**usual, **table.get("params", {})})
    except ParamError as error:
        return [f"params: {error}"]
    return find_conflicts(table)


def _accessory_problems(table: Mapping[str, Any]) -> list[str]:
    return accessory_settings.find_problems(msgspec.convert(table, Accessories))


_CHECKS: dict[str, Callable[[Any], list[str]]] = {
    "endpoints": _endpoint_problems,
    "motors": _motor_problems,
    "accessories": _accessory_problems,
    "params": _param_problems,
}
"""Section -> what its types cannot say."""
