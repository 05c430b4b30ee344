"""systemd as PID 1 of a container (boot_systemd.sh), if the kernel and our rights allow it."""

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
CHILDREN = Path("/proc/thread-self/children")
BOOT = 12.0
"""s until systemd must have started and run a service, or the tests are skipped; 1 on an idle machine."""
LOOK = 0.05
"""s between two checks whether systemd has started; its end is noticed at once."""
WITHIN = 120.0
"""s for one program in the container."""

ABLE = """\
[Service]
Type=oneshot
ExecStart=/opt/rover/bin/python3 -c "import gpiozero, msgspec; open('/opt/tree/pyproject.toml')"
DynamicUser=yes
SupplementaryGroups=dialout
StateDirectory=able
PrivateTmp=yes
PrivateMounts=yes
ProtectHome=yes
ProtectSystem=strict
ProtectProc=invisible
ProtectKernelTunables=yes
ProtectKernelModules=yes
ProtectKernelLogs=yes
ProtectControlGroups=yes
ProtectClock=yes
ProtectHostname=yes
RestrictNamespaces=yes
MemoryDenyWriteExecute=yes
KeyringMode=private
DevicePolicy=closed
IPAddressDeny=any
IPAddressAllow=localhost
SystemCallFilter=@system-service
CPUSchedulingPolicy=fifo
CPUSchedulingPriority=20
OOMScoreAdjust=-900
MemoryMax=256M
TasksMax=64
"""
"""A unit that needs of the machine what our service needs, without anything of ours."""


class UnableError(Exception):
    """This machine cannot run systemd in a container; the text says why."""


class Machine:
    """The running container. `root` is its file system as seen from outside."""

    def __init__(self, init: int, booted_by: float) -> None:
        self.root = Path(f"/proc/{init}/root")
        self.booted_by: float | None = booted_by
        """When to give up while systemd is not known to work, monotonic, s."""
        self._enter = ["nsenter", "--target", str(init), "--mount", "--pid", "--ipc", "--uts", "--wd=/"]

    def run(self, *words: str) -> tuple[int, str]:
        """Run a program in the container; return its exit code and output. Raises subprocess.TimeoutExpired."""
        done = subprocess.run(
            [*self._enter, *words],
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            check=False,
            timeout=WITHIN if self.booted_by is None else max(0.0, self.booted_by - time.monotonic()),
        )
        return done.returncode, done.stdout

    def property(self, name: str, unit: str) -> str:
        """Return a property of a unit."""
        return self.run("systemctl", "show", "--property", name, "--value", unit)[1].rstrip("\n")

    def install(self, name: str, unit: str) -> None:
        """Write a unit and let systemd read it."""
        self.write(f"/etc/systemd/system/{name}", unit)
        self.run("systemctl", "daemon-reload")

    def path(self, file: str) -> Path:
        """Return the path of a file in the container, as seen from outside."""
        return self.root / file.lstrip("/")

    def write(self, file: str, text: str) -> None:
        """Write a file in the container that every user may read."""
        path = self.path(file)
        path.parent.mkdir(exist_ok=True)
        path.write_text(text)
        path.chmod(0o644)

    def journal(self, unit: str) -> list[tuple[int, str]]:
        """Return priority and text of each line of the journal about a unit, including systemd's own."""
        self.run("journalctl", "--sync")
        lines = self.run("journalctl", "--unit", unit, "--output", "json", "--no-pager")[1].splitlines()
        entries: list[dict[str, Any]] = [json.loads(line) for line in lines if line.startswith("{")]
        return [(int(entry["PRIORITY"]), str(entry["MESSAGE"])) for entry in entries]


@contextlib.contextmanager
def booted(folder: Path) -> Iterator[Machine]:
    """Run a container until the end. Raises UnableError if services of this kind cannot run here."""
    if os.geteuid() != 0:
        raise UnableError("systemd as PID 1 needs root")
    if not SYSTEMD.exists():
        raise UnableError(f"there is no {SYSTEMD} (Debian: systemd)")
    if not CHILDREN.exists():
        raise UnableError(f"the kernel has no {CHILDREN}")
    said = folder / "boot.log"
    root = folder / "root"
    root.mkdir()
    words = ["setpriv", "--pdeathsig", "TERM", "unshare", "--mount", "bash", str(TREE / "tests/e2e/boot_systemd.sh")]
    words += [str(root), str(TREE), sysconfig.get_path("purelib"), sys.base_prefix]
    try:
        with said.open("wb") as log:
            outer = subprocess.Popen(words, stdin=subprocess.DEVNULL, stdout=log, stderr=log)
    except OSError as error:
        raise UnableError(f"{error.filename}: {error.strerror}") from error
    try:
        yield _started(outer, said)
    finally:
        _end(outer)


def _started(outer: subprocess.Popen[bytes], said: Path) -> Machine:
    deadline = time.monotonic() + BOOT
    told = ""
    try:
        while time.monotonic() < deadline:
            for machine in (Machine(init, deadline) for init in _inits(outer.pid)):
                told = machine.run("systemctl", "is-system-running")[1].strip()
                if told == "running":
                    _able(machine)
                    return machine
            with contextlib.suppress(subprocess.TimeoutExpired):
                outer.wait(LOOK)
                raise UnableError(f"no systemd of our own here: {_last(said)}")
    except subprocess.TimeoutExpired as error:
        told = f"it waits for {' '.join(error.cmd[-2:])}"
    except OSError as error:  # no nsenter, or the container has just ended
        raise UnableError(f"no systemd of our own here: {error} {_last(said)}".rstrip()) from error
    raise UnableError(f"no systemd of our own within {BOOT:g} s: {told} {_last(said)}".rstrip())


def _last(said: Path) -> str:
    return said.read_text(errors="replace").strip()[-200:]


def _able(machine: Machine) -> None:
    machine.install("able.service", ABLE)
    code, told = machine.run("systemctl", "start", "able.service")
    if code != 0:
        why = [text for _, text in machine.journal("able.service")] or [told.strip()]
        raise UnableError(f"systemd starts no confined service here: {'; '.join(why)[-300:]}")
    machine.booted_by = None


def _end(outer: subprocess.Popen[bytes]) -> None:
    """End systemd, which ends everything inside; the script then cleans up."""
    for _ in range(10):  # a signal before systemd is ready may be lost
        outer.terminate()
        with contextlib.suppress(subprocess.TimeoutExpired):
            outer.wait(1)
            return
    outer.kill()  # the kernel then ends everything that it has started
    outer.wait(30)


def _inits(outer: int) -> list[int]:
    """Return the systemd among the descendants of a process."""
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
