"""The computers of a page: namespaces of Linux with addresses, names, serial cables and home folders of their own.

`within` is the command that starts a program in them; that program makes Machines. All processes of a page end with it.
It needs root, or a kernel that lets users have namespaces.
"""

from __future__ import annotations

import os
import pty
import select
import socket
import subprocess
import sys
import threading
import tty
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parents[2]

ADDRESSES = {
    "192.168.1.20": (),
    "192.0.2.1": ("fleet.example.org", "a.example.org"),
}
"""Example addresses, which are loopback here -> names of them."""
CABLES = ("ttyAMA0", "ttyUSB0", "ttyACM0")
"""Serial ports: what is written to /dev/NAME arrives at /dev/far-NAME, and the other way round."""
MINE = "me"
"""The reader's own machine, in a clone of the project."""

SSH = """#!/bin/sh
# ssh HOST COMMAND...: another machine is another home folder
host=$1; shift; cd "$MACHINES/${host#*@}" && exec env HOME="$PWD" XDG_RUNTIME_DIR="$PWD/.run" sh -c "$*"
"""
SCP = """#!/bin/sh
# scp HOST:FILE TO
exec cp "$MACHINES/${1%%:*}/${1#*:}" "$2"
"""
BARRED = """#!/bin/sh
echo "$(basename "$0") would change this computer or needs a network: explain the block with <!-- not run: -->" >&2
exit 99
"""
STAND_INS = {
    "ssh": SSH,
    "scp": SCP,
    **dict.fromkeys(("sudo", "apt", "apt-get", "pip", "pip3", "systemctl", "reboot", "poweroff", "git"), BARRED),
}
"""Programs that do not run as they are -> what runs in their place."""


def within(*command: str) -> list[str]:
    """Return a command that runs another one in the namespaces."""
    own = [] if os.geteuid() == 0 else ["--user", "--map-root-user"]
    return ["unshare", *own, "--net", "--mount", "--pid", "--ipc", "--fork", "--mount-proc", "--kill-child", *command]


@cache
def why_not() -> str | None:
    """Return why there can be no such namespaces here; None: there can."""
    try:
        done = subprocess.run(within("ip", "link", "set", "lo", "up"), capture_output=True, text=True)
    except OSError as error:
        return str(error)
    return " ".join(done.stderr.split()) if done.returncode else None


class Machines:
    """What the pages assume, made in the namespaces of this process."""

    def __init__(self, folder: Path) -> None:
        """`folder` is empty, and gone after the page."""
        _run("ip", "link", "set", "lo", "up")
        self._folder = folder
        self._name(folder)
        self.programs = folder / "bin"
        """The first folder of PATH."""
        self.programs.mkdir()
        for name, script in STAND_INS.items():
            (self.programs / name).write_text(script)
            (self.programs / name).chmod(0o755)
        self._plug(folder / "dev")
        self._clone()

    def folder(self, machine: str) -> Path:
        """Return the folder in which one types on a machine."""
        home = self._folder / "home" / machine
        (home / ".run").mkdir(mode=0o700, parents=True, exist_ok=True)
        return home / "mavhelm" if machine == MINE else home

    def environment(self, machine: str) -> dict[str, str]:
        """Return the environment of a new terminal there."""
        venv = str(Path(sys.executable).parent)
        home = self._folder / "home" / machine
        return {
            "HOME": str(home),
            "USER": machine,
            "XDG_RUNTIME_DIR": str(home / ".run"),
            "MACHINES": str(home.parent),
            "PATH": f"{self.programs}:{venv}:/usr/local/bin:/usr/bin:/bin:/usr/sbin:/sbin",
            "LANG": "C.UTF-8",
            "CLONE": str(ROOT),
            "VENV": str(Path(sys.executable).parents[1]),
        }

    def _name(self, folder: Path) -> None:
        names = f"127.0.0.1 localhost\n::1 localhost\n127.0.1.1 {socket.gethostname()}\n"
        for address, others in ADDRESSES.items():
            _run("ip", "address", "add", f"{address}/32", "dev", "lo")
            names += f"{address} {' '.join(others)}\n" if others else ""
        (folder / "hosts").write_text(names)
        _run("mount", "--bind", str(folder / "hosts"), "/etc/hosts")

    def _plug(self, devices: Path) -> None:
        """Lay a folder over /dev that has the usual devices and CABLES."""
        devices.mkdir()
        _run("mount", "-t", "tmpfs", "devices", str(devices))
        for name in ("null", "zero", "full", "random", "urandom", "tty"):
            (devices / name).touch()
            _run("mount", "--bind", f"/dev/{name}", str(devices / name))
        for name, options in (("devpts", "newinstance,ptmxmode=0666"), ("tmpfs", "mode=1777")):
            place = devices / {"devpts": "pts", "tmpfs": "shm"}[name]
            place.mkdir()
            _run("mount", "-t", name, "-o", options, name, str(place))
        (devices / "ptmx").symlink_to("pts/ptmx")
        for name, target in (("fd", "fd"), ("stdin", "fd/0"), ("stdout", "fd/1"), ("stderr", "fd/2")):
            (devices / name).symlink_to(f"/proc/self/{target}")
        _run("mount", "--rbind", str(devices), "/dev")
        devices = Path("/dev")
        ends = [_open_end(devices / name) for cable in CABLES for name in (cable, f"far-{cable}")]
        threading.Thread(target=_carry, args=(dict(zip(ends, _swapped(ends), strict=True)),), daemon=True).start()

    def _clone(self) -> None:
        """Make a clone of the project in MINE: what a page writes there does not get into this one."""
        clone = self.folder(MINE)
        clone.mkdir()
        for each in ROOT.iterdir():
            if not each.name.startswith("."):
                (clone / each.name).symlink_to(each)


def _open_end(path: Path) -> int:
    """Return the end of a terminal line whose other end is `path`."""
    near, far = pty.openpty()
    tty.setraw(far)
    os.set_blocking(near, False)
    path.symlink_to(os.ttyname(far))
    return near


def _swapped(ends: list[int]) -> list[int]:
    return [ends[number ^ 1] for number in range(len(ends))]


def _carry(ends: dict[int, int]) -> None:
    while True:
        for end in select.select([*ends], [], [])[0]:
            try:
                os.write(ends[end], os.read(end, 4096))
            except OSError:
                continue  # nobody reads there: a UART would have lost it, too


def _run(*command: str) -> None:
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode:
        raise SystemExit(f"{' '.join(command)}: {done.stderr.strip()}")
