"""The file of settings: what it takes, and what one line says about each slip of the pen."""

from __future__ import annotations

import contextlib
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.rows import each_row
from vehicle.config.config import Config, Identity, LogSettings, RoverConfigError, load, parse_config
from vehicle.sensors.gps import GpsSettings
from vehicle.sensors.suite import SensorSettings


def problems(text: str) -> tuple[str, ...]:
    with pytest.raises(RoverConfigError) as refusal:
        parse_config(text, "rover.toml")
    assert not any("\n" in problem for problem in refusal.value.problems)
    return refusal.value.problems


def test_an_empty_file_is_all_defaults() -> None:
    assert parse_config("", "rover.toml") == Config()


def test_every_section_is_read() -> None:
    text = """
endpoints = ["udpin:0.0.0.0:14550", "serial:/dev/ttyAMA0:57600"]
state = "/srv/rover"
[identity]
system = 7
[motors]
driver = "roboclaw"
port = "/dev/serial0"
safety = { estop_pin = 17 }
[sensors]
computer = false
[sensors.gps]
host = "10.0.0.2"
[params]
MAN_TIMEOUT = 0.3
SPEED_MAX = 2
[log]
file = "/var/log/rover"
verbose = true
motors = "/tmp/motors"
"""
    assert parse_config(text, "rover.toml") == Config(
        endpoints=("udpin:0.0.0.0:14550", "serial:/dev/ttyAMA0:57600"),
        state="/srv/rover",
        identity=Identity(system=7),
        motors={"driver": "roboclaw", "port": "/dev/serial0", "safety": {"estop_pin": 17}},
        sensors=SensorSettings(gps=GpsSettings(host="10.0.0.2"), computer=False),
        params={"MAN_TIMEOUT": 0.3, "SPEED_MAX": 2.0},
        log=LogSettings(file="/var/log/rover", verbose=True, motors="/tmp/motors"),
    )


ROBOCLAW = '[motors]\ndriver = "roboclaw"\nport = "/dev/x"\n'
GPIO = '[motors]\ndriver = "gpio"\n[[motors.bridges]]\n'


@each_row(
    ("text", "says"),
    [
        ('endpont = ["a"]', "endpont: unknown key; did you mean endpoints?"),
        (
            "zebra = 1",
            "zebra: unknown key; there are endpoints, announce, state, identity, signing, motors, accessories, "
            "sensors, camera, params, log",
        ),
        ("a =", "Invalid value (at end of document)"),
        ("[params]\n\n[params]", "[params] exists already, and again at line 3; move its lines below the first one"),
        ("[motors.safety]\n[motors.safety]", "[motors.safety] exists already, and again at line 2; move"),
        ("state = 'a'\nstate = 'b'\n", "the key is set already, at line 2, column 12; remove one of them"),
        ('endpoints = "x"', 'endpoints: must be a list in [brackets], not text in "quotes"'),
        (
            'endpoints = ["udpin:1.2.3.4:5", "udpot:1:2"]',
            "endpoints[1]: endpoint 'udpot:1:2': did you mean udpout:1:2?",
        ),
        ("state = true", 'state: must be text in "quotes", not true or false'),
        ("log = 3", "log: must be a table, not a whole number"),
        ("[log]\nverbos = true", "log.verbos: unknown key; did you mean verbose?"),
        ("[identity]\nsystem = 0", "identity.system: must be at least 1"),
        ("[identity]\nsystem = 256", "identity.system: must be at most 255"),
        ("[identity]\nsystem = 2.5", "identity.system: must be a whole number, not a number"),
        ("[identity]\nsystem = 2\n[params]\nMAV_SYSID = 2", "params.MAV_SYSID: identity.system sets the same value"),
        ('[motors]\nport = "x"', "motors.driver: missing; add it, one of simulated, gpio, "),
        ("[motors]\ndriver = 3", "motors.driver: missing"),
        ('[motors]\ndriver = "robclaw"', "motors.driver: unknown motor driver 'robclaw'; did you mean 'roboclaw'?"),
        ('[motors]\ndriver = "no_such:Car"', "motors.driver: motor driver 'no_such:Car' cannot be loaded"),
        ('[motors]\ndriver = "roboclaw"', "motors.port: missing; add it"),
        ('[motors]\ndriver = "simulated"\nx = 1', "motors.x: unknown key; there is only safety"),
        (ROBOCLAW + "buad = 38400", "motors.buad: unknown key; did you mean baud?"),
        (ROBOCLAW + "baud = 3", "motors.baud: must be at least 2400"),
        (ROBOCLAW + 'baud = "fast"', 'motors.baud: must be a whole number, not text in "quotes"'),
        (ROBOCLAW + "safty = {}", "motors.safty: unknown key; did you mean safety?"),
        (ROBOCLAW + "shape = [{}, {reversed = true}]", "motors.shape: unknown key; there are "),
        (ROBOCLAW + "safety = {estop_pin = 40}", "motors.safety.estop_pin: must be at most 27"),
        (ROBOCLAW + "[motors.limits]\ndriving = 0.6", "motors.limits: unknown key; there are "),
        (GPIO + 'wiring = "two-input"', "motors.bridges[0].wiring: 'two-input' is not known; did you mean two-inputs?"),
        (GPIO + "forward = 1", "motors.bridges[0].wiring: missing; add it, one of two-inputs, phase-enable"),
        (GPIO + 'wiring = "two-inputs"\nfoward = 1', "motors.bridges[0].foward: unknown key; did you mean forward?"),
        (GPIO + 'wiring = "two-inputs"\nforward = 1\nbackward = 1', "motors: GPIO 1 is used twice"),
        ('[motors]\ndriver = "gpio"\nbridges = []', "motors.bridges: must have at least 1 entry"),
        ('[sensors]\nbatery = 1', "sensors.batery: unknown key; did you mean battery?"),
        ('[[sensors.rangefinders]]\ndriver = "hc-sr4"', "sensors.rangefinders[0].driver: 'hc-sr4' is not known"),
        ('[[sensors.rangefinders]]\ndriver = "vl53l0x"\nnumber = 9', "sensors.rangefinders[0].number: "),
        ('[sensors.battery]\nkind = "ina218"', "sensors.battery.kind: 'ina218' is not known; did you mean ina219 or"),
        ("[sensors.gps]\nport = 0", "sensors.gps.port: must be at least 1"),
        ("[sensors.encoders]\nwheels = [{ a = 5, b = 5 }]", "sensors.encoders: GPIO 5 is used twice"),
        ("[params]\nMAN_TIMOUT = 1", "params.MAN_TIMOUT: unknown parameter; did you mean MAN_TIMEOUT"),
        ("[params]\nman_timeout = 1", "params.man_timeout: unknown parameter; did you mean MAN_TIMEOUT"),
        ("[params]\nMAN_TIMEOUT = 9", "params.MAN_TIMEOUT: must be 0.2 to 2, not 9"),
        ("[params]\nMAN_TIMEOUT = nan", "params.MAN_TIMEOUT: must be 0.2 to 2, not nan"),
        ("[params]\nMOT1_MIN = 81", "params.MOT1_MIN: must be 0 to 80, not 81"),
        ("[params]\nMOT1_MIN = 60\nMOT1_MAX = 60", "params: MOT1_MIN 60 must be smaller than MOT1_MAX 60"),
        ("[params]\nMOT2_MAX = 30\nMOT2_MIN = 40", "params: MOT2_MIN 40 must be smaller than MOT2_MAX 30"),
        ('[motors]\ndriver = "article-car"\n[params]\nMOT1_MIN = 70', "params: MOT1_MIN 70 must be smaller than MOT1"),
        (f"[params]\nMAN_TIMEOUT = {10**400}", "params.MAN_TIMEOUT: the number is too large"),
        (f"[params]\nMAN_TIMEOUT = {'1' * 5000}", "a number with thousands of digits"),
        ("x = " + "[" * 5000 + "]" * 5000, "lists or tables are nested too deep"),
        ("a" + ".a" * 3000 + " = 1", "lists or tables are nested too deep"),
        ("x = " + "[" * 40 + "]" * 40, "lists or tables are nested too deep"),
        ('[log]\nfile = "a\\u0000b"', "log.file: contains the character NUL; remove it"),
        ('endpoints = ["udpin:0.0.0.0:1", "serial:/dev/\\u0000:9600"]', "endpoints[1]: contains the character NUL"),
        ("[sensors.encoders]\nwheels = [{ a = 5, b = 6 }]\ndiameter = inf", "sensors.encoders.diameter: must be at "),
        ('[params]\nMAN_TIMEOUT = "1"', "params.MAN_TIMEOUT: must be a number"),
        ("[params]\nMAN_TIMEOUT = true", "params.MAN_TIMEOUT: must be a number"),
    ],
)  # fmt: skip
def test_a_mistake_is_one_line_that_says_where_and_what_to_do(text: str, says: str) -> None:
    found = problems(text)
    assert len(found) == 1
    assert found[0].startswith(f"rover.toml: {says}")


def test_several_mistakes_are_all_found() -> None:
    text = 'endpoints = ["a"]\nlgo = 1\n[motors]\ndriver = "gpoi"\n[params]\nMAN_TIMEOUT = 9\nX = 1\n'
    found = problems(text)
    assert [each.split(": ")[1] for each in found] == [
        "endpoints[0]", "lgo", "motors.driver", "params.MAN_TIMEOUT", "params.X"
    ]  # fmt: skip
    assert str(RoverConfigError(*found)) == f"{found[0]} (and 4 more; see `mavhelm vehicle check`)"


def test_a_file_that_is_not_there_teaches(tmp_path: Path) -> None:
    with pytest.raises(
        RoverConfigError, match=r"No such file or directory; `mavhelm vehicle init .*rover.toml` writes a template"
    ):
        load(tmp_path / "rover.toml")
    with pytest.raises(RoverConfigError, match=r"aaa: File name too long$"):
        load("a" * 300)
    with pytest.raises(RoverConfigError, match="is a directory; name a file in it"):
        load(tmp_path)
    (tmp_path / "noise").write_bytes(b"\xff\xfe")
    with pytest.raises(RoverConfigError, match="byte 1 is not UTF-8 text; save the file as UTF-8, or name another one"):
        load(tmp_path / "noise")


def test_the_mark_of_a_windows_editor_is_no_mistake(tmp_path: Path) -> None:
    (tmp_path / "rover.toml").write_bytes(b"\xef\xbb\xbfstate = '/srv'\r\n")
    assert load(tmp_path / "rover.toml").state == "/srv"


@given(st.text())
def test_any_text_is_settings_or_a_refusal(text: str) -> None:
    with contextlib.suppress(RoverConfigError):
        assert isinstance(parse_config(text, "f"), Config)
