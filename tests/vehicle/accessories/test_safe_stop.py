"""The real vehicle with a relay and a servo beside its motors: commands reach the hardware; an end, or kill -9 and
safe-stop, leaves it safe."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import pytest

from dialects.enums import Command
from dialects.messages import CommandLong, RelayStatus, ServoOutputRaw
from tests.vehicle.accessories.across_processes import NAME
from tests.vehicle.ground import Ground, Vehicle, drive, running
from tests.vehicle.motors.across_processes import NAME as MOTORS
from tests.vehicle.motors.across_processes import FiledPca9685
from tests.vehicle.motors.filed_pins import Header, installed
from tests.vehicle.words import said_by
from tests.waits import PATIENCE
from vehicle.accessories.safe_stop import safe_stop

PUMP, LAMP, TILT = 16, 20, 4
"""Pins of the relays 0 and 1, channel of servo 9."""


@dataclass
class Rig:
    """A rover's hardware."""

    header: Header
    chip: FiledPca9685
    file: Path

    @property
    def active(self) -> bool:
        """Relay 0 and the servo have what they were told; relay 1 is on since the start."""
        tilt = self.chip.pulse(TILT)
        on = {PUMP, LAMP} <= self.header.driven_high()
        return on and tilt is not None and abs(tilt - 1.7e-3) < 5e-6

    @property
    def safe(self) -> bool:
        """Nothing is driven, and no servo is held."""
        return not self.header.driven_high() and self.chip.pulse(TILT) is None


def settings(folder: Path) -> str:
    """Motors and servo at one board."""
    registers = folder / "registers"
    return f"""
[motors]
driver = "{MOTORS}:Pca9685"
registers = "{registers}"
channels = [{{ channel = 0 }}, {{ channel = 1 }}]
[[accessories.relays]]
number = 0
driver = "gpio"
pin = {PUMP}
[[accessories.relays]]
number = 1
driver = "gpio"
pin = {LAMP}
start = true
until = "end"
[[accessories.servos]]
number = 9
driver = "{NAME}:FiledServo"
registers = "{registers}"
channel = {TILT}
"""


@contextmanager
def active(folder: Path) -> Iterator[tuple[Rig, Ground, Vehicle]]:
    """It drives, and its accessories have been told something."""
    rig_file = folder / "rover.toml"
    with installed(folder) as header, Ground() as ground:
        rig = Rig(header, FiledPca9685(folder / "registers"), rig_file)
        rig_file.write_text(f'endpoints = ["{ground.endpoint}"]\n{settings(folder)}')
        with running(folder, "--config", str(rig_file)) as vehicle:
            assert "ready" in vehicle.ready()
            drive(ground, vehicle)

            def told() -> bool:
                for command, number, value in ((Command.DO_SET_RELAY, 0, 1), (Command.DO_SET_SERVO, 9, 1700)):
                    ground.say(CommandLong(1, 1, command, 0, number, value, 0, 0, 0, 0, 0))
                return rig.active

            ground.wait(told, "relay and servo do as they are told")
            yield rig, ground, vehicle


def heard(ground: Ground) -> bool:
    relays = [each for each in ground.heard if isinstance(each, RelayStatus)]
    servos = [each for each in ground.heard if isinstance(each, ServoOutputRaw)]
    return bool(relays and servos) and (relays[-1].on, servos[-1].servo9_raw) == (0b11, 1700)


@pytest.mark.e2e
def test_after_a_kill_safe_stop_makes_accessories_safe(tmp_path: Path) -> None:
    with active(tmp_path) as (rig, ground, vehicle):
        ground.wait(lambda: heard(ground), "telemetry tells so")
        vehicle.process.kill()
        vehicle.process.wait(PATIENCE)
        assert rig.active  # nobody is there to end it
        rig.file.write_text("[motors\n")  # broken meanwhile: what the vehicle had is known all the same
        words = [sys.executable, "-m", "vehicle", "safe-stop", "--config", str(rig.file)]
        environment = {**os.environ, "XDG_STATE_HOME": str(tmp_path)}
        ended = subprocess.run(words, capture_output=True, text=True, check=False, timeout=PATIENCE, env=environment)
        assert ended.returncode == 0
        assert rig.safe, ended.stderr
        assert rig.chip.pulse(0) == pytest.approx(1.5e-3, abs=5e-6)
        assert ended.stderr.splitlines()[1:] == [
            f"mavhelm vehicle safe-stop: {MOTORS}:Pca9685: motors neutral and without power",
            "mavhelm vehicle safe-stop: relay 0: off",
            "mavhelm vehicle safe-stop: relay 1: off",
            "mavhelm vehicle safe-stop: servo 9: no pulses",
        ]


@pytest.mark.e2e
def test_an_end_by_a_signal_makes_them_safe(tmp_path: Path) -> None:
    with active(tmp_path) as (rig, _, vehicle):
        vehicle.process.terminate()
        assert vehicle.ended()[0] == 0
        assert rig.safe
        assert rig.chip.pulse(0) == pytest.approx(1.5e-3, abs=5e-6)


@pytest.mark.e2e
def test_an_emergency_stop_makes_safe_what_does_not_stay(tmp_path: Path) -> None:
    with active(tmp_path) as (rig, ground, _):

        def stopped() -> bool:
            ground.say(CommandLong(1, 1, Command.DO_SET_SAFETY_SWITCH_STATE, 0, 0, 0, 0, 0, 0, 0, 0))
            return rig.header.driven_high() == {LAMP} and rig.chip.pulse(TILT) is None

        ground.wait(stopped, "the pump is off and the servo let go; the lamp stays on")


def test_what_cannot_be_made_safe_is_said_and_the_rest_is_tried(tmp_path: Path) -> None:
    chip = FiledPca9685(tmp_path / "registers")
    chip.write_byte_data(0x40, 0, 0x20)
    chip.write_i2c_block_data(0x40, 6 + 4 * TILT, [0, 0, 0x99, 0x01])
    servo = {"driver": f"{NAME}:FiledServo", "number": 9, "registers": str(tmp_path / "registers"), "channel": TILT}
    tables = {
        "relays": [{"driver": "gpio", "number": 0}, 3, {"driver": "nothing"}],
        "servos": [servo, {**servo, "channel": 99}],
    }
    told = [words for _, words in safe_stop(tables)]
    assert [well for well, _ in safe_stop(tables)] == [False, False, False, True, False]
    assert chip.pulse(TILT) is None
    assert told[3] == "servo 9: no pulses"
    assert [line.partition(":")[0] for line in told] == [
        "accessories.relays[0]", "accessories.relays[1]", "accessories.relays[2]", "servo 9", "accessories.servos[1]",
    ]  # fmt: skip
    assert all("may still have its last value" in line for line in told if line.startswith("accessories"))


@pytest.mark.parametrize("tables", [None, 3, [], {}, {"relays": 3}, {"relays": {"a": 1}}, {"other": []}])
def test_tables_that_are_none_hold_nobody_up(tables: object) -> None:
    assert list(safe_stop(tables)) == []


def test_a_mistake_in_accessories_does_not_keep_motors_turning(tmp_path: Path) -> None:
    file = tmp_path / "rover.toml"
    file.write_text('accessories = 3\n[motors]\ndriver = "simulated"\n')
    code, _, error = said_by("safe-stop", "--config", str(file))
    assert (code, error) == (0, "mavhelm vehicle safe-stop: simulated: motors neutral and without power\n")
    file.write_text('[motors]\ndriver = "simulated"\n[accessories]\nrelays = [{ driver = "simulated" }]\n')
    code, _, error = said_by("safe-stop", "--config", str(file))
    assert code == 0
    assert error.splitlines()[0] == "mavhelm vehicle safe-stop: simulated: motors neutral and without power"
    assert error.splitlines()[1].startswith(
        "mavhelm vehicle safe-stop: accessories.relays[0]: may still have its last value: "
    )


def test_it_needs_neither_the_loop_nor_the_dialect(tmp_path: Path) -> None:
    """It must be there soon: motors are stopped by the same program."""
    file = tmp_path / "rover.toml"
    relay = '[[accessories.relays]]\nnumber = 0\ndriver = "simulated"\n'
    file.write_text(f'[motors]\ndriver = "simulated"\n{relay}')
    script = (
        f"import sys; from vehicle.__main__ import main; code = main(['safe-stop', '--config', {str(file)!r}]); "
        "sys.exit(code or 'asyncio' in sys.modules or 'dialects.rover' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", script], check=False).returncode == 0
