"""kill -9 while the wheels turn, then safe-stop as systemd runs it: every kind of hardware ends neutral."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, suppress
from dataclasses import dataclass
from pathlib import Path

import pytest

from dialects.enums import Command
from dialects.messages import CommandLong
from tests.vehicle.ground import TRY, Ground, Vehicle, drive, running
from tests.vehicle.motors.across_processes import NAME, FiledPca9685
from tests.vehicle.motors.controllers import RoboClaw, Sabertooth
from tests.vehicle.motors.fake_sysfs import FakeSysfs
from tests.vehicle.motors.filed_pins import PINS, installed
from tests.vehicle.motors.pty_controller import OnPty
from tests.vehicle.words import said_by
from tests.waits import PATIENCE

pytestmark = pytest.mark.xdist_group("motor drivers")  # each driver can be used by one vehicle at a time


class DeafToTime:
    """A controller whose own serial timeout does not work: only a command stops it."""

    def tick(self, now: float) -> None:
        """Time changes nothing."""


class StubbornRoboClaw(DeafToTime, RoboClaw):
    pass


class StubbornSabertooth(DeafToTime, Sabertooth):
    pass


@dataclass
class Rig:
    """Hardware, and the [motors] that fit it."""

    motors: str
    turning: Callable[[], bool]
    silent: Callable[[], bool] = lambda: True
    """Nothing beside the wheels is left on either."""


def roboclaw(opened: ExitStack, folder: Path) -> Rig:
    line = opened.enter_context(OnPty(StubbornRoboClaw()))
    return Rig(f'driver = "roboclaw"\nport = "{line.path}"\nreply_time = 0.05', lambda: any(line.controller.outputs))


def sabertooth(opened: ExitStack, folder: Path) -> Rig:
    line = opened.enter_context(OnPty(StubbornSabertooth()))
    words = f'driver = "sabertooth"\nport = "{line.path}"\ntimeout_proven = true'
    return Rig(words, lambda: any(line.controller.outputs))


def pca9685(opened: ExitStack, folder: Path) -> Rig:
    chip = FiledPca9685(folder / "registers")
    channels = "[{channel = 0}, {channel = 1}]"
    words = f'driver = "{NAME}:Pca9685"\nregisters = "{folder / "registers"}"\nchannels = {channels}'
    return Rig(words, lambda: _away_from_neutral(chip.pulse(0)) or _away_from_neutral(chip.pulse(1)))


def sysfs(opened: ExitStack, folder: Path) -> Rig:
    tree = FakeSysfs(folder)
    outputs = ", ".join(f'{{drives = "servo", device = "fe20c000.pwm", channel = {number}}}' for number in (0, 1))
    words = f'driver = "{NAME}:SysfsPwm"\nroot = "{tree.root}"\noutputs = [{outputs}]'
    there = tree.channel(1)
    return Rig(words, lambda: there.exists() and any(_away_from_neutral(tree.pulse(number)) for number in (0, 1)))


def on_pins(motors: str, inputs: set[int], enable: int | None = None) -> Callable[[ExitStack, Path], Rig]:
    """A bridge's `inputs`, of which any high one turns a wheel, and what has to be high too."""

    def rig(opened: ExitStack, folder: Path) -> Rig:
        header = opened.enter_context(installed(folder))

        def turning() -> bool:
            high = header.driven_high()
            return bool(inputs & high) and (enable is None or enable in high)

        return Rig(motors, turning, lambda: not any(header.level(number) for number in range(PINS)))

    return rig


def _away_from_neutral(pulse: float | None) -> bool:
    """Farther than a step of the chip."""
    return pulse is not None and abs(pulse - 1.5e-3) > 5e-6


TWO_INPUTS = """driver = "gpio"
bridges = [
    { wiring = "two-inputs", forward = 5, backward = 6 }, { wiring = "two-inputs", forward = 19, backward = 26 }
]"""
INPUTS_AND_ENABLE = """driver = "gpio"
bridges = [
    { wiring = "two-inputs", forward = 5, backward = 6, enable = 12 },
    { wiring = "two-inputs", forward = 19, backward = 26, enable = 13 },
]"""
PHASE_ENABLE = """driver = "gpio"
bridges = [
    { wiring = "phase-enable", enable = 13, phase = 16 }, { wiring = "phase-enable", enable = 12, phase = 20 }
]"""
ARTICLE_CAR = 'driver = "article-car"'
BESIDE = "safety = { enable_pin = 22, heartbeat_pin = 27 }"

RIGS = {
    "roboclaw": roboclaw,
    "sabertooth": sabertooth,
    "pca9685": pca9685,
    "sysfs-pwm": sysfs,
    "gpio, two inputs": on_pins(TWO_INPUTS, {5, 6, 19, 26}),
    "gpio, inputs and enable": on_pins(INPUTS_AND_ENABLE, {12, 13}),
    "gpio, phase and enable": on_pins(PHASE_ENABLE, {13, 12}),
    "article-car": on_pins(ARTICLE_CAR, {10, 9, 8, 7}),
    "article-car with safety pins": on_pins(f"{ARTICLE_CAR}\n{BESIDE}", {10, 9, 8, 7}, enable=22),
}


@pytest.fixture(params=RIGS)
def rig(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Rig]:
    with ExitStack() as opened:
        yield RIGS[request.param](opened, tmp_path)


@pytest.mark.e2e
def test_after_a_kill_safe_stop_ends_what_turns(rig: Rig, tmp_path: Path) -> None:
    kill_while_it_turns(rig, tmp_path, drive)
    ends_what_turns(rig, tmp_path)


@pytest.mark.e2e
def test_after_a_kill_in_a_motor_test_safe_stop_ends_it(tmp_path: Path) -> None:
    def test(ground: Ground, vehicle: Vehicle) -> None:
        ground.wait(lambda: bool(ground.heard), "a first message of the vehicle")
        ground.wait(lambda: asked(ground) or vehicle.turning(), "a wheel turns")
        assert not ground.armed

    def asked(ground: Ground) -> bool:
        ground.say(CommandLong(1, 1, Command.DO_MOTOR_TEST, 0, 1, 0, 30, 3, 0, 0, 0))
        return False

    with ExitStack() as opened:
        rig = pca9685(opened, tmp_path)
        kill_while_it_turns(rig, tmp_path, test)
        ends_what_turns(rig, tmp_path)


@pytest.mark.e2e
@pytest.mark.parametrize(
    ("now", "says"),
    [
        ("[motors\n", "rover.toml: Expected ']'"),
        (None, "rover.toml: No such file or directory; stopping only the motors that the vehicle used"),
        ('[motors]\ndriver = "simulated"\n', "mavhelm vehicle safe-stop: simulated: motors neutral and without power"),
    ],
    ids=["broken", "gone", "other motors"],
)
def test_a_file_changed_during_the_drive_keeps_nothing_turning(tmp_path: Path, now: str | None, says: str) -> None:
    file = tmp_path / "rover.toml"
    with ExitStack() as opened:
        rig = roboclaw(opened, tmp_path)
        kill_while_it_turns(rig, tmp_path, drive)
        file.unlink() if now is None else file.write_text(now)
        code, said = safe_stop(file)
        assert code == 0
        assert says in said
        assert "mavhelm vehicle safe-stop: roboclaw: motors neutral and without power\n" in said
        assert not rig.turning()


@pytest.mark.e2e
def test_a_vehicle_that_ends_as_it_should_leaves_nothing_to_stop(tmp_path: Path) -> None:
    file, kept = tmp_path / "rover.toml", tmp_path / "mavhelm"
    with Ground() as ground:
        file.write_text(f'endpoints = ["{ground.endpoint}"]\n[motors]\ndriver = "simulated"\n')
        with running(tmp_path, "--config", str(file)) as vehicle:
            assert "ready" in vehicle.ready()
            assert len(list(kept.glob("motors-*.json"))) == 1
            vehicle.process.terminate()
            assert vehicle.ended()[0] == 0
    assert list(kept.glob("motors-*")) == []


def kill_while_it_turns(rig: Rig, tmp_path: Path, turn: Callable[[Ground, Vehicle], None]) -> None:
    """`turn` makes the wheels turn, and they go on: what follows must end it.

    Again if a failsafe of the vehicle has ended it just before the kill, because the machine was late.
    """
    deadline = time.monotonic() + PATIENCE
    _drive_and_kill(rig, tmp_path, turn)
    while not rig.turning():  # nobody is there to stop it
        assert time.monotonic() < deadline, "no wheel turns after the kill"
        _drive_and_kill(rig, tmp_path, turn)


def _drive_and_kill(rig: Rig, tmp_path: Path, turn: Callable[[Ground, Vehicle], None]) -> None:
    file = tmp_path / "rover.toml"
    with Ground() as ground:
        file.write_text(f'endpoints = ["{ground.endpoint}"]\n[motors]\n{rig.motors}\n')
        with running(tmp_path, "--config", str(file)) as vehicle:
            assert "ready" in vehicle.ready()
            turn(ground, vehicle)
            with suppress(AssertionError):
                ground.wait(rig.turning, "the hardware turns the wheels", TRY)
            vehicle.process.kill()
            vehicle.process.wait(PATIENCE)


def safe_stop(file: Path) -> tuple[int, str]:
    """As systemd runs it: exit code, and what it says."""
    words = [sys.executable, "-m", "vehicle", "safe-stop", "--config", str(file)]
    environment = {**os.environ, "XDG_STATE_HOME": str(file.parent)}
    ended = subprocess.run(words, capture_output=True, text=True, check=False, timeout=PATIENCE, env=environment)
    return ended.returncode, ended.stderr


def ends_what_turns(rig: Rig, folder: Path) -> None:
    code, said = safe_stop(folder / "rover.toml")
    assert code == 0
    assert said.endswith("motors neutral and without power\n")
    assert said.count("\n") == 1
    assert not rig.turning()
    assert rig.silent()


def test_a_mistake_elsewhere_in_the_file_keeps_no_motor_turning(tmp_path: Path) -> None:
    with ExitStack() as opened:
        rig = pca9685(opened, tmp_path)
        chip = FiledPca9685(tmp_path / "registers")
        file = tmp_path / "rover.toml"
        file.write_text(f"endpoint = 3\n[motors]\n{rig.motors}\n[params]\nNO_SUCH = 1\n")
        chip.write_byte_data(0x40, 0, 0x20)
        chip.write_i2c_block_data(0x40, 6, [0, 0, 0x99, 0x01])
        assert rig.turning()
        assert said_by("safe-stop", "--config", str(file))[0] == 0
        assert not rig.turning()


def test_a_motor_that_cannot_be_stopped_is_named_with_code_0(tmp_path: Path) -> None:
    file = tmp_path / "rover.toml"
    file.write_text('[motors]\ndriver = "roboclaw"\nport = "/dev/nowhere"\n')
    code, _, error = said_by("safe-stop", "--config", str(file))
    assert code == 0
    first, last = error.splitlines()
    assert "/dev/nowhere" in first
    assert last == "mavhelm vehicle safe-stop: roboclaw: motors may still turn, cut their power"


@pytest.mark.parametrize("text", ["", "[motors]\n", "motors = 1\n", "[motors\n", "\udcff"])
def test_a_file_without_motors_is_a_mistake(tmp_path: Path, text: str) -> None:
    file = tmp_path / "rover.toml"
    file.write_bytes(text.encode("utf-8", "surrogateescape"))
    code, out, error = said_by("safe-stop", "--config", str(file))
    assert (code, out, error.count("\n")) == (2, "", 1)
    assert str(file) in error
    assert error.endswith("; nothing is stopped: cut the power of motors that turn, and fix the file\n")


def test_no_file_is_a_mistake(tmp_path: Path) -> None:
    code, _, error = said_by("safe-stop", "--config", str(tmp_path / "none"))
    what_to_do = "nothing is stopped: cut the power of motors that turn, and fix the file"
    assert code == 2
    assert error == f"mavhelm vehicle safe-stop: {tmp_path / 'none'}: No such file or directory; {what_to_do}\n"


def test_it_needs_neither_the_loop_nor_the_dialect(tmp_path: Path) -> None:
    """It must be there soon: wheels turn until then."""
    file = tmp_path / "rover.toml"
    file.write_text('[motors]\ndriver = "simulated"\n')
    script = (
        f"import sys; from vehicle.__main__ import main; code = main(['safe-stop', '--config', {str(file)!r}]); "
        "sys.exit(code or 'asyncio' in sys.modules or 'dialects.rover' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", script], check=False).returncode == 0


@pytest.mark.e2e
@pytest.mark.parametrize(
    ("text", "marks"),
    [
        ('[motors]\ndriver = "roboclaw"\nport = "/dev/nowhere"\n', ["<3>", "<2>"]),
        ('[motors]\ndriver = "simulated"\n', ["<6>"]),
        ("[motors\n", ["<3>"]),
    ],
    ids=["may still turn", "stopped", "broken file"],
)
def test_the_journal_learns_how_bad_it_is(tmp_path: Path, text: str, marks: list[str]) -> None:
    file = tmp_path / "rover.toml"
    file.write_text(text)
    reader, writer = os.pipe()
    stream = os.fstat(writer)
    subprocess.run(
        [sys.executable, "-m", "vehicle", "safe-stop", "--config", str(file)],
        stderr=writer,
        check=False,
        timeout=PATIENCE,
        env={**os.environ, "JOURNAL_STREAM": f"{stream.st_dev}:{stream.st_ino}", "XDG_STATE_HOME": str(tmp_path)},
    )
    os.close(writer)
    with open(reader, encoding="utf-8") as said:
        assert [line[:3] for line in said] == marks
