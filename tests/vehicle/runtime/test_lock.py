"""One program at a time for one set of motors, and for one folder of kept things."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from vehicle.config.run_settings import SettingsError
from vehicle.motors import MotorError
from vehicle.runtime.lock import InUseError, MotorLock, lock_state_folder

# A serial port of each test's own, so that tests that run at the same time do not meet.
MINE = {"driver": "roboclaw", "port": f"/dev/test-{os.getpid()}"}
KILLED = """
from vehicle.runtime import lock
lock.HAS_ABSTRACT_NAMES = {names}
mine = lock.MotorLock({motors})
print(flush=True)
input()
"""


@pytest.fixture(params=[True, False], ids=["abstract name", "file"])
def names(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> bool:
    """Whether sockets have abstract names, as on Linux and on macOS."""
    monkeypatch.setattr("vehicle.runtime.lock.HAS_ABSTRACT_NAMES", request.param)
    return bool(request.param)


@pytest.mark.usefixtures("names")
def test_the_second_is_refused_until_the_first_lets_go() -> None:
    first = MotorLock(MINE)
    with pytest.raises(InUseError, match="in use by another vehicle"):
        MotorLock({**MINE, "baud": 9600})
    first.close()
    first.close()
    MotorLock(MINE).close()


@pytest.mark.usefixtures("names")
def test_another_port_is_another_controller() -> None:
    first, second = MotorLock(MINE), MotorLock({**MINE, "port": MINE["port"] + "b"})
    first.close()
    second.close()


def test_a_port_has_one_lock_by_all_its_names_however_long(tmp_path: Path) -> None:
    port, name = tmp_path / "ttyUSB0", tmp_path / f"usb-{'x' * 200}-if00-port0"
    port.touch()
    name.symlink_to(port)
    first = MotorLock({**MINE, "port": str(name)})
    with pytest.raises(InUseError):
        MotorLock({**MINE, "port": str(port)})
    first.close()
    MotorLock({**MINE, "port": str(port)}).close()


@pytest.mark.parametrize("driver", ["simulated", "my_car:Motors"])
def test_simulated_motors_and_those_of_others_are_not_locked(driver: str) -> None:
    first, second = MotorLock({"driver": driver}), MotorLock({"driver": driver})
    first.close()
    second.close()


def test_a_killed_process_holds_nothing(names: bool) -> None:
    script = KILLED.format(names=names, motors=MINE)
    process = subprocess.Popen([sys.executable, "-c", script], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
    assert process.stdout is not None
    process.stdout.readline()
    with pytest.raises(InUseError):
        MotorLock(MINE)
    process.send_signal(signal.SIGKILL)
    process.communicate()
    MotorLock(MINE).close()


def test_a_link_in_the_place_of_a_lock_is_not_followed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("vehicle.runtime.lock.HAS_ABSTRACT_NAMES", False)
    monkeypatch.setattr("vehicle.runtime.lock.LOCK_FOLDER", tmp_path)
    MotorLock(MINE).close()
    (lock,) = tmp_path.iterdir()
    lock.unlink()
    lock.symlink_to(tmp_path / "elsewhere")
    with pytest.raises(MotorError, match="the lock of the motors"):
        MotorLock(MINE)
    assert not (tmp_path / "elsewhere").exists()


def test_a_second_vehicle_of_a_folder_waits_for_the_first_to_end(tmp_path: Path) -> None:
    folder = tmp_path / "new" / "state"
    words = f"state folder {folder} is in use by another vehicle; stop it, or set another folder with --state"
    with lock_state_folder(folder), pytest.raises(SettingsError, match=words), lock_state_folder(folder):
        pass
    with lock_state_folder(folder), lock_state_folder(tmp_path):
        pass


def test_a_killed_vehicle_holds_no_folder(tmp_path: Path) -> None:
    script = f"""
from pathlib import Path
from vehicle.motors import MotorError
from vehicle.runtime.lock import lock_state_folder
with lock_state_folder(Path({str(tmp_path)!r})):
    print(flush=True); input()
"""
    process = subprocess.Popen([sys.executable, "-c", script], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
    assert process.stdout is not None
    process.stdout.readline()
    with pytest.raises(SettingsError), lock_state_folder(tmp_path):
        pass
    process.send_signal(signal.SIGKILL)
    process.communicate()
    with lock_state_folder(tmp_path):
        pass


@pytest.mark.parametrize("folder", ["file", "file/inside", "loop"])
def test_a_folder_that_is_none_is_not_the_locks_matter(folder: str, tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    (tmp_path / "loop").symlink_to("loop")
    with lock_state_folder(tmp_path / folder):
        pass
