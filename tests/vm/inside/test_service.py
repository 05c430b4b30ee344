"""The unit that `mavhelm vehicle systemd-unit` prints, under systemd of the virtual machine, with motors at pins."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.vehicle.ground import Ground
from tests.vm.inside.header import GPIO, ahead, drive, silent, write_config

UNIT = "rover.service"
UNITS = Path("/etc/systemd/system")
SAFE_STOP = "mavhelm vehicle safe-stop: article-car: motors neutral"
DROP_IN = """\
[Service]
{watchdog}
TimeoutStartSec=300
TimeoutStopSec=150
# PrivateTmp= hides the file, ProtectProc= the board's revision.
BindPaths={folder}
BindReadOnlyPaths=/etc/vm-cpuinfo:/proc/cpuinfo
"""
"""What an emulated machine needs beside the unit as it is printed."""
WITHIN = 120.0
"""s: two programs must start in an emulated machine."""


class Service:
    """rover.service, installed as its first lines say."""

    def __init__(self, folder: Path, ground: Ground, watchdog: str) -> None:
        self._ground = ground
        config = write_config(folder, ground.endpoint, GPIO)
        command = [sys.executable, "-m", "vehicle", "systemd-unit", "--config", str(config)]
        unit = subprocess.run(command, capture_output=True, text=True, check=True).stdout
        (UNITS / UNIT).write_text(unit)
        (UNITS / f"{UNIT}.d").mkdir(exist_ok=True)
        (UNITS / f"{UNIT}.d" / "test.conf").write_text(DROP_IN.format(watchdog=watchdog, folder=folder))
        self.systemctl("daemon-reload")
        self.systemctl("start", UNIT)

    def systemctl(self, *words: str) -> str:
        done = subprocess.run(["systemctl", *words], capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr + self.journal()
        return done.stdout

    def pid(self) -> int:
        return int(self.systemctl("show", "--value", "--property=MainPID", UNIT))

    def journal(self) -> str:
        command = ["journalctl", "--no-pager", "--output=cat", "--unit", UNIT]
        return subprocess.run(command, capture_output=True, text=True, check=True).stdout

    def drive(self) -> int:
        """Return the daemon's process id once the wheels turn."""
        drive(self._ground)
        self._ground.wait(ahead, "both motors run forward", WITHIN)
        return self.pid()

    def back(self, ended: int) -> bool:
        active = self.systemctl("show", "--value", "--property=ActiveState", UNIT).strip() == "active"
        return active and self.pid() not in (0, ended)


@pytest.fixture
def ground() -> Iterator[Ground]:
    with Ground() as ground:
        yield ground
    subprocess.run(["systemctl", "stop", UNIT], check=False)


def test_kill_9_while_it_drives(tmp_path: Path, ground: Ground) -> None:
    service = Service(tmp_path, ground, "WatchdogSec=60")
    killed = service.drive()
    os.kill(killed, signal.SIGKILL)
    ground.demand = None
    ground.wait(silent, "safe-stop has set the pins low", WITHIN)
    assert SAFE_STOP in service.journal()
    ground.wait(lambda: service.back(killed), "systemd has started it again", WITHIN)
    assert silent()


def test_a_hang_while_it_drives(tmp_path: Path, ground: Ground) -> None:
    service = Service(tmp_path, ground, "WatchdogSec=5")
    hung = service.drive()
    os.kill(hung, signal.SIGSTOP)
    ground.demand = None
    ground.wait(silent, "the watchdog has killed it and safe-stop has set the pins low", WITHIN)
    assert SAFE_STOP in service.journal()
    ground.wait(lambda: service.back(hung), "systemd has started it again", WITHIN)


def test_it_stops_in_order(tmp_path: Path, ground: Ground) -> None:
    service = Service(tmp_path, ground, "WatchdogSec=60")
    service.drive()
    service.systemctl("stop", UNIT)
    assert silent()
    assert "stopped by SIGTERM, motors neutral" in service.journal()
