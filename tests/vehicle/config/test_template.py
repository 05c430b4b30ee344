"""The sample and the schema are made of the tables in the code, so they can only be right or fail here."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from typing import Any

import msgspec
import pytest

from tests.vehicle.words import said_by
from vehicle.config.config import Config, LogSettings, parse_config
from vehicle.config.template import LISTENING, SIMULATED, build_template
from vehicle.motors.drivers import DRIVERS, settings_type
from vehicle.motors.settings import CommonMotorSettings, SafetyPinSettings
from vehicle.params import TABLE, Params
from vehicle.sensors.suite import SensorSettings

BLOCKS = re.split(r"^# ---- (.+?)(?::.*)?$|^(?=\[sensors\])", build_template(), flags=re.MULTILINE)
OWN = [name for name in DRIVERS if name != "simulated"]


def made_live(text: str) -> str:
    """With every setting in force."""
    return re.sub(r"^#(?=[\w\[])", "", text, flags=re.MULTILINE)


def live(text: str) -> dict[str, Any]:
    """... as tables."""
    return tomllib.loads(made_live(text))


def block(title: str) -> str:
    """What stands below a line `# ---- title`."""
    return str(BLOCKS[BLOCKS.index(title) + 1])


def test_as_it_is_it_holds_the_defaults() -> None:
    assert parse_config(build_template(), "rover.toml") == Config(endpoints=tuple(LISTENING), motors=SIMULATED)


def test_everything_in_it_is_a_setting() -> None:
    text = "".join(part for part in (BLOCKS[0], BLOCKS[-1]) if part)
    found = parse_config(made_live(text).replace("MAV_SYSID", "#"), "rover.toml")
    assert set(live(text)) == set(Config.__struct_fields__)
    assert set(live(text)["log"]) == set(LogSettings.__struct_fields__)
    assert found.log.verbose is LogSettings().verbose


def test_every_parameter_is_in_it_at_its_default() -> None:
    assert live(BLOCKS[-1])["params"] == {parameter.name: parameter.default for parameter in TABLE}
    assert Params(live(BLOCKS[-1])["params"])


def test_every_sensor_is_in_it_with_every_key_at_its_default() -> None:
    table = live(BLOCKS[-1])["sensors"]
    assert set(table) == set(SensorSettings.__struct_fields__)
    required = {"battery": {"kind": "ina219"}, "gps": {}, "encoders": {"wheels": table["encoders"]["wheels"]}}
    lists = {"rangefinders": table["rangefinders"], "lidar": table["lidar"]}
    settings = msgspec.convert(required | lists, SensorSettings)
    assert msgspec.convert(table, SensorSettings) == settings
    assert tuple(table["rangefinders"]) == msgspec.to_builtins(settings)["rangefinders"]
    for name in required:
        assert set(table[name]) == set(msgspec.to_builtins(msgspec.convert(table, SensorSettings))[name])


@pytest.mark.parametrize("name", OWN)
def test_every_driver_is_in_it_with_every_key_at_its_default(name: str) -> None:
    text = made_live("[motors]\n" + block(name))
    table = tomllib.loads(text)["motors"]
    assert parse_config(text, "rover.toml").motors == table
    assert table.pop("driver") == name
    kind = settings_type(name)
    assert kind is not None
    if DRIVERS[name].profile:
        return
    fields = msgspec.structs.fields(kind)
    assert set(table) == {field.name for field in fields}
    for field in fields:
        assert field.required or table[field.name] == field.default


def test_what_goes_around_a_driver_is_in_it() -> None:
    text = made_live(block("for any driver"))
    table = tomllib.loads(text)["motors"]
    assert set(table) == set(CommonMotorSettings.__struct_fields__)
    assert set(table["safety"]) == set(SafetyPinSettings.__struct_fields__)
    assert parse_config(f'[motors]\ndriver = "simulated"\n{text}', "rover.toml").motors["safety"]


def test_init_writes_it_once(tmp_path: Path) -> None:
    file = tmp_path / "rover.toml"
    assert said_by("init", str(file)) == (0, f"wrote {file}; edit it, then run: mavhelm vehicle check {file}\n", "")
    assert file.read_text() == build_template()
    file.write_text("mine")
    code, _, error = said_by("init", str(file))
    assert (code, error) == (2, f"mavhelm vehicle init: {file} exists already; choose another name, or remove it\n")
    assert file.read_text() == "mine"
    code, _, error = said_by("init", str(tmp_path / "no" / "folder"))
    assert (code, error.count("\n")) == (2, 1)
