"""The serial ports of this machine: what is plugged in, its driver, and which program has it open.

Reading them takes some milliseconds: callers that must not wait use a thread.
"""

from __future__ import annotations

import contextlib
import os
from pathlib import Path

import msgspec
from serial.tools import list_ports

from link.transport.processes import PROC, ask_lsof, describe_process, open_files, other_processes, program_name

TTY_CLASS = Path("/sys/class/tty")
LOGINS = ("getty", "agetty")
"""Programs that wait for a login on a port: the arguments name it. They belong to root, who hides their descriptors."""


class SerialPort(msgspec.Struct, frozen=True):
    """One port."""

    path: str
    description: str = ""
    """What is plugged in, as it describes itself; "" if it does not."""
    ids: str = ""
    """USB vendor and product, e.g. "0403:6015"."""
    driver: str = ""
    """Name of the kernel's driver, e.g. "ftdi_sio"."""
    holder: str = ""
    """Program that has it open, with its process id."""
    allowed: bool = True
    """This user may open it."""


def find_serial_ports(proc: Path = PROC) -> list[SerialPort]:
    """Return all ports, by path."""
    ports = sorted(list_ports.comports(), key=lambda port: str(port.device))
    holders = find_holders([str(port.device) for port in ports], proc)
    return [
        SerialPort(
            path=str(port.device),
            description=_description(str(port.description or "")),
            ids=f"{port.vid:04x}:{port.pid:04x}" if port.vid is not None and port.pid is not None else "",
            driver=_driver(Path(str(port.device)).name),
            holder=holders.get(str(port.device), ""),
            allowed=os.access(str(port.device), os.R_OK | os.W_OK),
        )
        for port in ports
    ]


def find_holders(paths: list[str], proc: Path = PROC) -> dict[str, str]:
    """Return which program has each of these files open, e.g. "screen (pid 412)". Ours are left out.

    Processes of other users hide what they have open, except a login that names the port in its arguments.
    """
    real = {os.path.realpath(path): path for path in paths}
    found: dict[str, str] = {}
    if not real:
        return found
    if not proc.is_dir():
        return {real[each.name]: each.holder for each in ask_lsof("--", *real) if each.name in real}
    for process in other_processes(proc):
        opened = {os.path.realpath(target) for target in open_files(process, "/dev/")}
        for path in [real[each] for each in opened & real.keys()] + _login_ports(process, paths):
            found.setdefault(path, describe_process(process))
    return found


def _login_ports(process: Path, paths: list[str]) -> list[str]:
    if program_name(process) not in LOGINS:
        return []
    with contextlib.suppress(OSError):
        words = (process / "cmdline").read_bytes().decode("utf-8", "replace").split("\0")
        return [path for path in paths if Path(path).name in words or path in words]
    return []


def _description(text: str) -> str:
    """Return the description without pyserial's word for none."""
    return "" if text == "n/a" else "".join(filter(str.isprintable, text))


def _driver(name: str) -> str:
    with contextlib.suppress(OSError):
        return os.path.basename(os.readlink(TTY_CLASS / name / "device" / "driver"))
    return ""
