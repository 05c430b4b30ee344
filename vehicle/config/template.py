"""The commented configuration file that `mavhelm vehicle init` writes, with every key and its default."""

from __future__ import annotations

import json
import textwrap
from collections.abc import Mapping
from typing import Any

import msgspec

from link.runtime.docstrings import field_docs, first_paragraph
from vehicle.accessories.drivers import DRIVERS as ACCESSORY_DRIVERS
from vehicle.accessories.drivers import FIRST_NUMBER, AccessoryKind
from vehicle.accessories.settings import COMMON, Accessories
from vehicle.accessories.settings import settings_type as settings_type_of
from vehicle.camera.settings import CameraSettings
from vehicle.config.config import Config
from vehicle.config.signing import SigningSettings
from vehicle.motors.drivers import DRIVERS, DriverEntry, settings_type
from vehicle.motors.settings import CommonMotorSettings, NoSettings
from vehicle.params import TABLE, Parameter
from vehicle.sensors.suite import SensorSettings

WIDTH = 116

SIMULATED: dict[str, Any] = {"driver": "simulated"}
LISTENING = ["udpin:0.0.0.0:14550"]
"""The two values that the template sets, so that it runs unchanged: 14550 is the usual port of ground stations."""

COMMON_MOTOR: dict[str, Any] = {
    "safety": {"estop_pin": 17, "enable_pin": 22, "heartbeat_pin": 27},
}
SENSORS: dict[str, Any] = {
    "battery": {"kind": "ina219"},
    "gps": {},
    "rangefinders": [
        {"driver": "hc-sr04", "number": 1, "trigger": 5, "echo": 6},
        {"driver": "vl53l0x", "number": 2},
        {"driver": "vl53l1x", "number": 3, "bus": 3},
        {"driver": "tfmini", "number": 4, "port": "/dev/ttyUSB0"},
    ],
    "lidar": {"driver": "ld06", "port": "/dev/ttyUSB1"},
    "encoders": {"wheels": [{"a": 23, "b": 24}, {"a": 25, "b": 26}]},
}
TOP: dict[str, Any] = {
    "state": "/var/lib/mavhelm",
    "identity": {"system": 1},
    "log": {"file": "/var/log/rover.log", "motors": "/tmp/motors.log", "tlog": "/var/lib/mavhelm/logs"},
}

HEAD = """\
# Configuration of the vehicle. `mavhelm vehicle --config rover.toml` runs with it,
# `mavhelm vehicle check rover.toml` checks it.
#
# A line like "#key = value", without a space after #, is a setting: remove the # to set it. The value shown is the
# default, or an example if there is no default. An unknown key is an error, so that a typing error is not ignored.
# Editors with JSON schema support can check and complete this file: mavhelm vehicle schema > rover.schema.json

"""


def build_template() -> str:
    """Return the text of the file."""
    config = msgspec.convert({**TOP, "endpoints": LISTENING, "motors": SIMULATED}, Config)
    sensors = msgspec.convert(SENSORS, SensorSettings)
    common_motor = msgspec.convert(COMMON_MOTOR, CommonMotorSettings)
    parts = [
        HEAD,
        _line("endpoints", list(config.endpoints), Config, active=True),
        _line("announce", config.announce, Config),
        _line("state", config.state, Config),
        "\n[identity]\n" + _body(config.identity, "identity"),
        f"\n[signing]\n{_comment(first_paragraph(SigningSettings.__doc__))}" + _body(config.signing, "signing"),
        f"\n[motors]\n# One of {', '.join(DRIVERS)}; or your own as module:Class.\n"
        "# docs/pi.md describes the wiring of each.\n" + 'driver = "simulated"\n',
        *(_driver(name, entry) for name, entry in DRIVERS.items() if name != "simulated"),
        "\n# ---- for any driver\n" + _body(common_motor, "motors"),
        "\n[sensors]\n" + _body(sensors, "sensors"),
        f"\n[accessories]\n{_comment(first_paragraph(Accessories.__doc__))}# docs/pi.md describes their wiring.\n",
        *(
            _accessory(kind, name, entry)
            for kind, drivers in ACCESSORY_DRIVERS.items()
            for name, entry in drivers.items()
            if name != "simulated"
        ),
        f"\n[camera]\n{_comment(first_paragraph(CameraSettings.__doc__))}" + _body(config.camera, "camera"),
        "\n[params]\n# Ground stations can read a parameter that is set here, but cannot change it.\n",
        *(_parameter(parameter) for parameter in TABLE),
        "\n[log]\n" + _body(config.log, "log"),
    ]
    return "".join(parts)


def _driver(name: str, entry: DriverEntry) -> str:
    """Return the commented settings of one motor driver."""
    heading = f"\n# ---- {name}: {entry.title}\n"
    if entry.profile:
        params = ", ".join(f"{key} = {value:g}" for key, value in entry.params.items())
        note = f"# Its parameter defaults: {params}.\n" if params else ""
        return f'{heading}{note}#driver = "{name}"\n'
    settings: msgspec.Struct = msgspec.convert(entry.example, settings_type(name) or NoSettings)
    return f'{heading}#driver = "{name}"\n{_body(settings, "motors")}'


def _accessory(kind: AccessoryKind, name: str, entry: DriverEntry) -> str:
    """Return the commented table of one accessory driver, with every key."""
    structs = (COMMON[kind], settings_type_of(kind, name) or NoSettings)
    known = f"{name}: {entry.title}. One of {', '.join(ACCESSORY_DRIVERS[kind])}; or your own as module:Class."
    header = f'\n#[[accessories.{kind}s]]\n{_comment(known)}#driver = "{name}"\n'
    example = {"number": FIRST_NUMBER[kind], **entry.example}
    return header + "".join(_plain(example, each) for each in structs)


def _plain(example: Mapping[str, Any], kind: Any) -> str:
    """Return the keys of a table without subtables, as far as `kind` has them."""
    names = kind.__struct_fields__
    struct = msgspec.convert({key: value for key, value in example.items() if key in names}, kind)
    return "".join(_line(key, getattr(struct, key), kind) for key in names)


def _body(struct: msgspec.Struct, path: str) -> str:
    """Return every key of a table: plain keys first, as TOML requires, then the subtables."""
    kind = type(struct)
    plain, subtables = [], []
    tag = kind.__struct_config__.tag
    if tag is not None:
        plain.append(f"#{kind.__struct_config__.tag_field} = {_value(tag)}\n")
    for name in kind.__struct_fields__:
        value = getattr(struct, name)
        if isinstance(value, msgspec.Struct):
            subtables.append(_table(f"[{path}.{name}]", name, kind, value, f"{path}.{name}"))
        elif isinstance(value, tuple) and value and isinstance(value[0], msgspec.Struct):
            subtables += [_table(f"[[{path}.{name}]]", name, kind, each, f"{path}.{name}") for each in value]
        else:
            plain.append(_line(name, value, kind))
    return "".join(plain + subtables)


def _table(header: str, name: str, owner: type, value: msgspec.Struct, path: str) -> str:
    text = field_docs(owner).get(name) or first_paragraph(type(value).__doc__)
    return f"\n{_comment(text)}#{header}\n" + _body(value, path)


def _line(name: str, value: Any, owner: type, *, active: bool = False) -> str:
    if value is None:
        return ""
    text = f"{field_docs(owner).get(name, '')}{_default_note(owner, name)}"
    return f"{_comment(text.strip())}{'' if active else '#'}{name} = {_value(value)}\n"


def _default_note(owner: type, name: str) -> str:
    """Return a note if the value shown is not the default."""
    field = next(field for field in msgspec.structs.fields(owner) if field.name == name)
    if field.default is None:
        return " Not set by default."
    return " Required." if field.required else ""


def _parameter(parameter: Parameter) -> str:
    return f"{_comment(parameter_help(parameter))}#{parameter.name} = {parameter.default:g}\n"


def parameter_help(parameter: Parameter) -> str:
    """Return description and range of a parameter."""
    unit = f" {parameter.unit}" if parameter.unit else ""
    return f"{parameter.description} ({parameter.low:g} to {parameter.high:g}{unit})"


def _value(value: Any) -> str:
    if isinstance(value, str | list | tuple):
        return json.dumps(value)
    if isinstance(value, bool):
        return str(value).lower()
    return f"{value:.10g}"


def _comment(text: str) -> str:
    return "".join(f"# {line}\n" for line in textwrap.wrap(text, WIDTH))
