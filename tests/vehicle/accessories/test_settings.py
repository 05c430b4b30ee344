"""[accessories] of the file: what is a mistake, what clashes, what `check`, the sample and the schema say of it."""

from __future__ import annotations

import json
import re
import tomllib
from pathlib import Path
from typing import Any

import pytest
from msgspec.structs import fields

from link.runtime.command_line import USAGE_ERROR
from tests.rows import each_row
from tests.vehicle.accessories.across_processes import NAME
from tests.vehicle.motors.across_processes import FiledPca9685
from tests.vehicle.words import said_by
from vehicle.accessories.drivers import DRIVERS
from vehicle.accessories.output import PulseRange
from vehicle.accessories.settings import COMMON, build_specs, settings_type
from vehicle.config.config import RoverConfigError, parse_config
from vehicle.config.run_settings import RunSettings, Simulation
from vehicle.config.schema import build_schema
from vehicle.config.template import build_template
from vehicle.runtime import daemon
from vehicle.runtime.lock import MotorLock

RELAY = '[[accessories.relays]]\nnumber = 0\ndriver = "gpio"\npin = 16\n'
SERVO = '[[accessories.servos]]\nnumber = 9\ndriver = "pca9685"\nchannel = 4\n'
SIMULATED = '[[accessories.servos]]\nnumber = 9\ndriver = "simulated"\n'
BOARD = '[motors]\ndriver = "pca9685"\nchannels = [{ channel = 0 }, { channel = 1 }]\n'
PWM = '[motors]\ndriver = "sysfs-pwm"\noutputs = [{ drives = "servo", device = "x", channel = 0 }]\n'


def problem(text: str) -> str:
    with pytest.raises(RoverConfigError) as refusal:
        parse_config(text, "f")
    assert len(refusal.value.problems) == 1
    return refusal.value.problems[0].removeprefix("f: ")


def test_a_file_becomes_outputs() -> None:
    text = f'{RELAY}safe = true\nstart = true\nuntil = "disarm"\n{SERVO}min_us = 900\nsafe = "trim"\n{SIMULATED}'
    relay, servo, other = build_specs(
        parse_config(text.replace('9\ndriver = "sim', '10\ndriver = "sim'), "f").accessories
    )
    assert (relay.name, relay.driver, relay.start, relay.safe, relay.until) == ("relay 0", "gpio", 1, 1, "disarm")
    assert (servo.name, servo.start, servo.safe, servo.until) == ("servo 9", 1500, 1500, "stop")
    assert servo.pulses == PulseRange(900, 1500, 2000)
    assert (other.start, other.safe, other.pulses) == (0, 0, PulseRange(1000, 1500, 2000))


@each_row(
    ("text", "says"),
    [
        ("[accessories]\nrelay = []", "relay: unknown key; did you mean relays?"),
        ("[accessories]\nrelays = 1", "relays: must be a list in [brackets], not a whole number"),
        ("[[accessories.relays]]\nnumber = 0", "relays[0].driver: missing; add it, one of simulated, gpio"),
        (RELAY.replace("gpio", "gipo"), "relays[0].driver: unknown relay driver 'gipo'; did you mean 'gpio'"),
        (RELAY.replace("gpio", "no_such:Relay"), "relays[0].driver: relay driver 'no_such:Relay' cannot be"),
        (SERVO.replace("pca9685", "gpio"), "servos[0].driver: unknown servo driver 'gpio'; known: simulated,"),
        (RELAY + "activ_high = true", "relays[0].activ_high: unknown key; did you mean active_high?"),
        (RELAY.replace("pin = 16", ""), "relays[0].pin: missing; add it"),
        (RELAY.replace("pin = 16", "pin = 40"), "relays[0].pin: must be at most 27"),
        (RELAY.replace("number = 0", "number = 16"), "relays[0].number: must be at most 15"),
        (RELAY.replace("number = 0", ""), "relays[0].number: missing; add it"),
        (RELAY + "start = 1", "relays[0].start: must be true or false, not a whole number"),
        (RELAY + 'until = "never"', "relays[0].until: 'never' is not known; there are"),
        (RELAY + 'until = "disarm"\nstart = true', "relays[0]: start must equal safe if until is"),
        (RELAY + RELAY.replace("16", "17"), "relays[1].number: 0 is already used by accessories.relays[0]"),
        (RELAY + RELAY.replace("= 0", "= 1"), "relays[1]: GPIO 16 is already used by accessories.relays[0]"),
        (SERVO.replace("9", "0", 1), "servos[0].number: must be at least 1"),
        (SERVO + "max_us = 3000", "servos[0].max_us: must be at most 2500"),
        (SERVO + "trim_us = 2100", "servos[0]: min 1000 <= trim 2100 <= max 2000 us must hold"),
        (SERVO + "frequency = 400.0\nmax_us = 2400", "servos[0]: max_us 2400 does not fit into 400 Hz"),
        (SERVO + SERVO.replace("= 9", "= 10"), "servos[1]: channel 4 at address 0x40 on I2C bus 1 is already used by"),
        # what motors have
        ('[motors]\ndriver = "article-car"\n' + RELAY.replace("16", "10"), "relays[0]: GPIO 10 is already used by mo"),
        (BOARD + SERVO.replace("= 4", "= 1"), "servos[0]: channel 1 at address 0x40 on I2C bus 1 is already used by m"),
        (BOARD + RELAY.replace("16", "2"), "relays[0]: GPIO 2 may be used by the motors; use another pin"),
        (PWM + RELAY.replace("16", "12"), "relays[0]: GPIO 12 may be used by the motors; use another pin"),
        ('[motors]\ndriver = "roboclaw"\nport = "/dev/serial0"\n' + RELAY.replace("16", "14"), "relays[0]: GPIO"),
        (
            BOARD + SERVO + "frequency = 60.0",
            "servos[0]: address 0x40 on I2C bus 1 is a PCA9685 of 50 Hz with an oscillator of 2.5e+07 Hz "
            "in motors; set the same here",
        ),
        (SERVO + '[sensors.battery]\nkind = "ina219"', "servos[0]: address 0x40 on I2C bus 1 is already used by"),
    ],
)  # fmt: skip
def test_a_mistake_is_one_line_that_says_where_and_what_to_do(text: str, says: str) -> None:
    assert problem(text).startswith(f"accessories.{says}")


@pytest.mark.parametrize(
    "text",
    [
        BOARD + SERVO,
        SERVO + SERVO.replace("= 9", "= 10").replace("= 4", "= 5") + "address = 0x40\n",
        '[motors]\ndriver = "roboclaw"\nport = "/dev/ttyACM0"\n' + RELAY.replace("16", "14"),
        '[motors]\ndriver = "pca9685"\nbus = 3\nchannels = [{ channel = 0 }]\n' + RELAY.replace("16", "2"),
        PWM + RELAY,
        "[accessories]\n",
    ],
)
def test_parts_that_get_along_are_no_problem(text: str) -> None:
    parse_config(text, "f")


def test_a_servo_with_a_motors_number_is_refused_at_the_start(caplog: pytest.LogCaptureFixture) -> None:
    """Also in a simulation; which numbers are motors' depends on the kind of drive."""
    accessories = parse_config(SIMULATED.replace("9", "2"), "f").accessories
    for settings in (
        RunSettings(("udpout:127.0.0.1:9",), accessories=accessories, params={"DRIVE_TYPE": 4}),
        RunSettings(
            ("udpout:127.0.0.1:9",), accessories=accessories, params={"DRIVE_TYPE": 4}, simulation=Simulation()
        ),
    ):
        caplog.clear()
        assert daemon.run(settings) == USAGE_ERROR
        assert "servo 2 is a motor with DRIVE_TYPE 4; use another number" in caplog.text


def test_other_motors_than_the_files_are_looked_at_again(caplog: pytest.LogCaptureFixture) -> None:
    """`--motors` comes after the file was found right."""
    accessories = parse_config(RELAY.replace("16", "10"), "f").accessories
    settings = RunSettings(("udpout:127.0.0.1:9",), motors={"driver": "article-car"}, accessories=accessories)
    assert daemon.run(settings) == USAGE_ERROR
    assert "accessories.relays[0]: GPIO 10 is already used by motors" in caplog.text


# check


def checked(folder: Path, text: str, motors: str = 'driver = "simulated"\n') -> tuple[int, list[str]]:
    file = folder / "rover.toml"
    head = f'endpoints = ["udpout:127.0.0.1:9"]\n[sensors]\ncomputer = false\n[motors]\n{motors}'
    file.write_text(head + text)
    code, out, error = said_by("check", str(file), "--state", str(folder))
    assert error == ""
    return code, [line for line in out.splitlines() if "relay" in line or "servo" in line]


def filed_servo(folder: Path) -> str:
    return (
        f'[[accessories.servos]]\nnumber = 9\ndriver = "{NAME}:FiledServo"\nchannel = 4\nsafe = "trim"\n'
        f'registers = "{folder / "registers"}"\n'
    )


def test_check_opens_each_and_moves_none(tmp_path: Path) -> None:
    simulated = '[[accessories.relays]]\nnumber = 3\ndriver = "simulated"\nsafe = true\n'
    code, lines = checked(tmp_path, simulated + filed_servo(tmp_path))
    assert (code, lines) == (
        0, ["ok    relay 3: simulated, on", f"ok    servo 9: {NAME}:FiledServo, no pulses"]
    )  # fmt: skip
    chip = FiledPca9685(tmp_path / "registers")
    assert chip.frequency == pytest.approx(50, abs=0.1)  # it was there, and set up
    assert chip.pulse(4) is None


def test_check_says_what_does_not_answer_and_what_is_a_motor(tmp_path: Path) -> None:
    code, lines = checked(tmp_path, SERVO + "bus = 99\n")
    assert code == 1
    assert lines[0].startswith("FAIL  servo 9: I2C bus 99: ")
    code, lines = checked(tmp_path, SIMULATED.replace("9", "3"))
    assert code == 2
    assert lines[0] == "FAIL  settings: accessories: servo 3 is a motor with DRIVE_TYPE 1; use another number"


def test_check_touches_no_accessory_of_a_vehicle_that_runs(tmp_path: Path) -> None:
    port = str(tmp_path / "port")
    chip = FiledPca9685(tmp_path / "registers")
    before = chip.registers[:]
    lock = MotorLock({"driver": "roboclaw", "port": port})
    try:
        # Said otherwise than by the vehicle that runs: the whole board would be set up for it, motors and all.
        code, lines = checked(
            tmp_path, filed_servo(tmp_path) + "frequency = 60\n", f'driver = "roboclaw"\nport = "{port}"\n'
        )
        assert code == 1
        assert lines[0].startswith("FAIL  servo 9: the motors are in use by another vehicle")
        assert chip.registers[:] == before
    finally:
        lock.close()


# Sample and schema

LIVE = tomllib.loads(
    re.sub(r"^#(?=[\w\[])", "", build_template()[build_template().index("[accessories]") :], flags=re.MULTILINE)
)


@pytest.mark.parametrize("kind", COMMON)
def test_every_key_is_in_the_sample_at_its_default(kind: Any) -> None:
    [table] = LIVE["accessories"][f"{kind}s"]
    own = settings_type(kind, table["driver"])
    assert own is not None
    keys = {field.name: field for each in (COMMON[kind], own) for field in fields(each)}
    assert set(table) == {"driver", *keys}
    for name, field in keys.items():
        assert field.required or name == "address" or table[name] == field.default
    build_specs(parse_config(_toml(f"{kind}s", table), "f").accessories)


def _toml(name: str, table: dict[str, Any]) -> str:
    lines = (f"{key} = {json.dumps(value)}" for key, value in table.items())
    return "\n".join([f"[[accessories.{name}]]", *lines])


@pytest.mark.parametrize("kind", COMMON)
def test_the_schema_knows_every_driver_and_key(kind: Any) -> None:
    *known, own = json.loads(build_schema())["$defs"]["Accessories"]["properties"][f"{kind}s"]["items"]["oneOf"]
    assert [each["properties"]["driver"]["const"] for each in known] == list(DRIVERS[kind])
    assert own["properties"]["driver"]["pattern"] == ":"
    for each in known:
        own_kind = settings_type(kind, each["properties"]["driver"]["const"])
        names = getattr(own_kind, "__struct_fields__", ())
        assert set(each["properties"]) == {"driver", *COMMON[kind].__struct_fields__, *names}
        assert all(value.get("description") for key, value in each["properties"].items() if key != "driver")
        assert "number" in each["required"]
