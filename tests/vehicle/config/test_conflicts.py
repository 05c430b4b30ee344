"""A pin, chip or port that two parts of a file want: each part is right, and the vehicle would not start."""

from __future__ import annotations

from pathlib import Path

import pytest

from vehicle.config.config import RoverConfigError, load, parse_config

CAR = '[motors]\ndriver = "article-car"\n'
BOARD = '[motors]\ndriver = "pca9685"\nchannels = [{ channel = 0 }]\n'
PWM = '[motors]\ndriver = "sysfs-pwm"\noutputs = [{ drives = "bridge", device = "x", channel = 0, direction = 5 }]\n'


def wheels(*pins: int) -> str:
    return f"[sensors.encoders]\nwheels = [{{ a = {pins[0]}, b = {pins[1]} }}]\n"


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (CAR + "safety = { estop_pin = 7 }", "motors.safety: GPIO 7 is already used by motors"),
        (CAR + wheels(23, 10), "sensors.encoders: GPIO 10 is already used by motors"),
        (
            CAR + "safety = { enable_pin = 22 }\n" + wheels(22, 23),
            "sensors.encoders: GPIO 22 is already used by motors.safety",
        ),
        (PWM + wheels(5, 6), "sensors.encoders: GPIO 5 is already used by motors"),
        (
            BOARD + '[sensors.battery]\nkind = "ina219"',
            "sensors.battery: address 0x40 on I2C bus 1 is already used by motors",
        ),
        (
            '[[sensors.rangefinders]]\ndriver = "vl53l0x"\nnumber = 1\n'
            '[[sensors.rangefinders]]\ndriver = "vl53l1x"\nnumber = 2',
            "sensors.rangefinders[1]: address 0x29 on I2C bus 1 is already used by sensors.rangefinders[0]",
        ),
        (
            'endpoints = ["serial:/dev/ttyAMA0:57600"]\n[sensors.lidar]\ndriver = "ld06"\nport = "/dev/ttyAMA0"',
            "sensors.lidar: /dev/ttyAMA0 is already used by endpoints[0]",
        ),
    ],
)
def test_what_is_wanted_twice_is_said_before_anything_is_opened(text: str, says: str) -> None:
    with pytest.raises(RoverConfigError) as refusal:
        parse_config(text, "f")
    assert len(refusal.value.problems) == 1
    assert refusal.value.problems[0].startswith(f"f: {says}")


@pytest.mark.parametrize("driver", ["roboclaw", "sabertooth"])
def test_one_serial_port_cannot_be_the_link_and_the_motors(driver: str, tmp_path: Path) -> None:
    (tmp_path / "ttyAMA0").touch()
    (tmp_path / "serial0").symlink_to(tmp_path / "ttyAMA0")
    file = tmp_path / "rover.toml"
    motors = f'[motors]\ndriver = "{driver}"\nport = "{tmp_path}/serial0"\n'
    file.write_text(f'endpoints = ["udpin:0.0.0.0:14550", "serial:{tmp_path}/ttyAMA0:57600"]\n{motors}')
    with pytest.raises(RoverConfigError, match=r"motors: .*/ttyAMA0 is already used by endpoints\[1\]"):
        load(file)


@pytest.mark.parametrize(
    "text",
    [
        CAR + "safety = { estop_pin = 17 }\n" + wheels(23, 24),
        BOARD + 'address = 0x41\n[sensors.battery]\nkind = "ina219"',
        BOARD + '[sensors.battery]\nkind = "ina219"\nbus = 3',
        'endpoints = ["serial:/dev/ttyAMA0:57600"]\n[motors]\ndriver = "roboclaw"\nport = "/dev/ttyACM0"',
        '[motors]\ndriver = "simulated"',
    ],
)
def test_what_is_apart_is_left_alone(text: str) -> None:
    parse_config(text, "f")
