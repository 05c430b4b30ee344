"""The configuration file rover.toml: its keys, and checks with one line for each error.

To add a key, add a field here, with a docstring: that is its help in the template (template.py) and the JSON schema
(schema.py).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Annotated, Any, get_type_hints

import msgspec

from link.endpoint import EndpointError, parse_endpoint
from link.toml.errors import explain_errors, suggest
from link.toml.file import TomlError, find_unsupported, parse_toml, read_toml
from vehicle.accessories import settings as accessory_settings
from vehicle.accessories.settings import Accessories
from vehicle.camera.settings import CameraSettings
from vehicle.camera.settings import find_problems as find_camera_problems
from vehicle.config.conflicts import find_conflicts
from vehicle.config.signing import SigningSettings
from vehicle.config.signing import find_problems as find_signing_problems
from vehicle.motors import UnknownDriverError
from vehicle.motors.drivers import DRIVERS, profile_params, profile_settings, settings_type
from vehicle.motors.settings import CommonMotorSettings, NoSettings
from vehicle.params import PARAMETERS, ParamError, Params, suggest_parameter
from vehicle.sensors.suite import SensorSettings

DEFAULT_FILE = "rover.toml"


class RoverConfigError(Exception):
    """The configuration file is invalid. Each of `problems` is one line: file, key, error and remedy."""

    def __init__(self, *problems: str) -> None:
        more = f" (and {len(problems) - 1} more; see `mavhelm vehicle check`)" if len(problems) > 1 else ""
        super().__init__(problems[0] + more)
        self.problems = problems


class Identity(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Identity of this vehicle."""

    system: Annotated[int, msgspec.Meta(ge=1, le=255)] | None = None
    """MAVLink system id; without it the parameter MAV_SYSID applies (default 1)."""


class LogSettings(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Log files. The brief log always goes to stderr, and for a service to the journal."""

    file: str | None = None
    """Append the log to this file, with times and tracebacks. At 10 MB it becomes FILE.1, and a new one begins."""
    verbose: bool = False
    """Log more details."""
    motors: str | None = None
    """Append each change of the motor outputs to this file: CLOCK_MONOTONIC ns and the throttles."""
    tlog: str | None = None
    """Folder for the telemetry log of each drive; without it `logs` in the state folder."""


class Config(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The configuration file."""

    endpoints: tuple[str, ...] = ()
    """Links to ground stations. Who sends over a network needs a key to drive: see [signing]."""
    announce: bool = False
    """Announce the endpoints that listen (udpin, tcpin) on the network: needs the extra [discovery]."""
    state: str | None = None
    """Folder for parameters and plans set by ground stations; without it the service's own, or one in your home."""
    identity: Identity = Identity()
    signing: SigningSettings = SigningSettings()
    motors: dict[str, Any] = {}
    accessories: Accessories = Accessories()
    sensors: SensorSettings = SensorSettings()
    camera: CameraSettings = CameraSettings()
    params: dict[str, float] = {}
    log: LogSettings = LogSettings()


def load(path: str | Path) -> Config:
    """Read a configuration file. Raises RoverConfigError."""
    try:
        return _build(read_toml(path), str(path))
    except TomlError as error:
        absent = isinstance(error.__cause__, FileNotFoundError)
        hint = f"; `mavhelm vehicle init {path}` writes a template" if absent else ""
        raise RoverConfigError(f"{error}{hint}") from error


def parse_config(text: str, name: str) -> Config:
    """Parse the text of a configuration file. Raises RoverConfigError."""
    try:
        return _build(parse_toml(text, name), name)
    except TomlError as error:
        raise RoverConfigError(str(error)) from error


def _build(table: Mapping[str, Any], name: str) -> Config:
    problems = [f"{name}: {problem}" for problem in list(find_unsupported(table)) or _problems(table)]
    if problems:
        raise RoverConfigError(*problems)
    return msgspec.convert(table, Config)


def _problems(table: Mapping[str, Any]) -> list[str]:
    """Return one line for each mistake; of a section with mistakes in its types the further checks are left out."""
    kinds = get_type_hints(Config, include_extras=True) | {"params": dict[str, Any]}
    problems: list[str] = []
    for key, value in table.items():
        if key not in kinds:
            problems.append(f"{key}: unknown key; {suggest(key, kinds)}")
            continue
        mistakes = explain_errors(value, kinds[key], key)
        problems += mistakes or (_CHECKS[key](value) if key in _CHECKS else [])
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
    settings = {**profile_settings(name), **{key: value for key, value in table.items() if key != "driver"}}
    common_keys = CommonMotorSettings.__struct_fields__
    common = {key: value for key, value in settings.items() if key in common_keys}
    own = {key: value for key, value in settings.items() if key not in common}
    return _problem(common, CommonMotorSettings) + _problem(own, kind or NoSettings, common_keys)


def _problem(table: Mapping[str, Any], kind: Any, other_keys: tuple[str, ...] = ()) -> list[str]:
    return explain_errors(dict(table), kind, "motors", other_keys)


def _param_problems(table: Mapping[str, Any]) -> list[str]:
    found = ((name, _param_problem(name, value)) for name, value in table.items())
    return [f"params.{name}: {problem}" for name, problem in found if problem]


def _param_problem(name: str, value: Any) -> str | None:
    if name not in PARAMETERS:
        return f"unknown parameter; {suggest_parameter(name.upper())}"
    if isinstance(value, bool) or not isinstance(value, int | float):
        return "must be a number"
    try:
        Params({name: value})
    except ParamError as error:
        return str(error).removeprefix(f"{name} ")
    return None


def _contradictions(table: Mapping[str, Any]) -> list[str]:
    if "system" in table.get("identity", {}) and "MAV_SYSID" in table.get("params", {}):
        return ["params.MAV_SYSID: identity.system sets the same value; remove one of them"]
    usual = profile_params(table.get("motors", {}).get("driver", ""))
    try:
        Params({**usual, **table.get("params", {})})
    except ParamError as error:
        return [f"params: {error}"]
    return find_conflicts(table)


def _signing_problems(table: Mapping[str, Any]) -> list[str]:
    return find_signing_problems(msgspec.convert(table, SigningSettings))


def _camera_problems(table: Mapping[str, Any]) -> list[str]:
    return find_camera_problems(msgspec.convert(table, CameraSettings))


def _accessory_problems(table: Mapping[str, Any]) -> list[str]:
    return accessory_settings.find_problems(msgspec.convert(table, Accessories))


_CHECKS: dict[str, Callable[[Any], list[str]]] = {
    "endpoints": _endpoint_problems,
    "signing": _signing_problems,
    "motors": _motor_problems,
    "accessories": _accessory_problems,
    "camera": _camera_problems,
    "params": _param_problems,
}
"""Section -> checks beyond its types."""
