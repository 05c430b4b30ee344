"""systemd as PID 1 of a small machine inside this one (boot_systemd.sh), where the kernel and our rights allow it."""

from __future__ import annotations

import contextlib
import json
import os
import subprocess
import sys
import sysconfig
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

TREE = Path(__file__).resolve().parents[2]
SYSTEMD = Path("/usr/lib/systemd/systemd")
BOOT = 60.0
"""s until it must have started; 2 on an idle machine."""

ABLE = """\
[Service]
Type=oneshot
ExecStart=/opt/rover/bin/python3 -c "import gpiozero, msgspec"
DynamicUser=yes
SupplementaryGroups=dialout
StateDirectory=able
PrivateTmp=yes
ProtectHome=yes
ProtectSystem=strict
ProtectProc=invisible
DevicePolicy=closed
IPAddressDeny=any
SystemCallFilter=@system-service
CPUSchedulingPolicy=fifo
CPUSchedulingPriority=20
OOMScoreAdjust=-900
TimeoutStartSec=60
"""
"""What any service like ours needs of the machine, with nothing of ours in it."""


class UnableError(Exception):
    """This machine cannot do it; the text says why."""


class Machine:
    """The running one. `root` is its file system as we see it."""

    def __init__(self, init: int) -> None:
        self.root = Path(f"/proc/{init}/root")
        self._enter = ["nsenter", "--target", str(init), "--mount", "--pid", "--ipc", "--uts", "--wd=/"]

    def run(self, *words: str) -> tuple[int, str]:
        """Run a program in it: exit code, what it said."""
        done = subprocess.run(
            [*self._enter, *words],
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            check=False,
            timeout=120,
        )
        return done.returncode, done.stdout

    def property(self, name: str, unit: str) -> str:
        """What systemd says of a unit."""
        return self.run("systemctl", "show", "--property", name, "--value", unit)[1].rstrip("\n")

    def install(self, name: str, unit: str) -> None:
        """Write a unit and have systemd read it."""
        (self.root / "etc/systemd/system" / name).write_text(unit)
        self.run("systemctl", "daemon-reload")

    def journal(self, unit: str) -> list[tuple[int, str]]:
        """Priority and text of each line since the start of the machine, systemd's own about the unit too."""
        self.run("journalctl", "--sync")
        lines = self.run("journalctl", "--unit", unit, "--output", "json", "--no-pager")[1].splitlines()
        entries: list[dict[str, Any]] = [json.loads(line) for line in lines if line.startswith("{")]
        return [(int(entry["PRIORITY"]), str(entry["MESSAGE"])) for entry in entries]


@contextlib.contextmanager
def booted(folder: Path) -> Iterator[Machine]:
    """A machine until the end. Raises UnableError where services of this kind cannot run here, and why."""
    if os.geteuid() != 0:
        raise UnableError("systemd as PID 1 needs root")
    if not SYSTEMD.exists():
        raise UnableError(f"there is no {SYSTEMD} (Debian: systemd)")
    said = folder / "boot.log"
    root = folder / "root"
    root.mkdir()
    words = ["setpriv", "--pdeathsig", "KILL", "unshare", "--mount", "bash", str(TREE / "tests/e2e/boot_systemd.sh")]
    words += [str(root), str(TREE), sysconfig.get_path("purelib"), sys.base_prefix]
    try:
        with said.open("wb") as log:
            outer = subprocess.Popen(words, stdin=subprocess.DEVNULL, stdout=log, stderr=log)
    except FileNotFoundError as error:
        raise UnableError(f"there is no {error.filename}") from error
    try:
        machine = _started(outer, said)
        _able(machine)
        yield machine
    finally:
        for init in _inits(outer.pid):
            os.kill(init, 9)  # and with it everything inside; the script then clears up
        try:
            outer.wait(30)
        except subprocess.TimeoutExpired:
            outer.kill()
            outer.wait(30)


def _started(outer: subprocess.Popen[bytes], said: Path) -> Machine:
    deadline = time.monotonic() + BOOT
    told = ""
    while time.monotonic() < deadline:
        if outer.poll() is not None:
            raise UnableError(f"no systemd of our own here: {said.read_text(errors='replace').strip()[-200:]}")
        for init in _inits(outer.pid):
            machine = Machine(init)
            told = machine.run("systemctl", "is-system-running")[1].strip()
            if told == "running":
                return machine
        time.sleep(0.05)
    raise UnableError(f"systemd did not start here within {BOOT:g} s: {told} {said.read_text(errors='replace')[-200:]}")


def _able(machine: Machine) -> None:
    machine.install("able.service", ABLE)
    code, told = machine.run("systemctl", "start", "able.service")
    if code != 0:
        why = [text for _, text in machine.journal("able.service")] or [told.strip()]
        raise UnableError(f"systemd starts no confined service here: {'; '.join(why)[-300:]}")


def _inits(outer: int) -> list[int]:
    """The systemd among the descendants of a process."""
    found, left = [], [outer]
    while left:
        pid = left.pop()
        with contextlib.suppress(OSError):
            if os.readlink(f"/proc/{pid}/exe").endswith("/systemd"):
                found.append(pid)
                continue
        with contextlib.suppress(OSError):
            left += [int(child) for child in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]
    return found
