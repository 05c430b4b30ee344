"""Reads the facts for `mavhelm vehicle doctor` from the file, the kernel and systemd."""

from __future__ import annotations

import contextlib
import ctypes
import glob
import grp
import os
import pwd
import re
import shutil
import subprocess
import time
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from link.endpoint import parse_endpoint
from link.signing.key_file import FILE, KeyFileError, load_keys
from link.toml.file import read_toml
from link.transport.reach import find_trust, missing_interfaces
from link.transport.serial_ports import find_holders
from vehicle.cli.check import run_checks
from vehicle.cli.doctor.facts import Clock, Device, Space, VehicleDoctorFacts
from vehicle.config.config import load
from vehicle.config.conflicts import iter_taken
from vehicle.config.effective_params import load_effective_params
from vehicle.sensors.pi_health import PiHealth
from vehicle.storage.recorder import LOGS

GPIO_CHIPS = "/dev/gpiochip*"
COMMAND_LINE = Path("/proc/cmdline")
UNIT = "rover.service"
PROPERTIES = ("LoadState", "ActiveState", "SubState", "UnitFileState", "ExecMainStatus", "NRestarts")
SYSTEMCTL_TIMEOUT = 5.0
"""s; a computer that just boots answers late."""
TIMEX_SIZE, TIME_ERROR = 512, 5
"""Bytes, more than struct timex has; result of adjtimex() for a clock that is not synchronized (adjtimex(2))."""
_BUS = re.compile(r"on I2C bus (\d+)$")


def gather_facts(path: str, state: str | None) -> VehicleDoctorFacts:
    """Return the facts for the configuration file `path`. `state` replaces its state folder."""
    checks = tuple(run_checks(path, state))
    known = _of_file(path, state) if checks and checks[0].ok else {}
    return VehicleDoctorFacts(
        path=path,
        user=_user(),
        checks=checks,
        health=PiHealth().sample(),
        clock=read_clock(),
        service=read_service(),
        **known,
    )


def _of_file(path: str, state: str | None) -> dict[str, Any]:
    """Return the facts that need a file without errors."""
    config, taken = load(path), [name for _, name, _ in iter_taken(read_toml(path))]
    effective = load_effective_params(config, state)
    logs = Path(config.log.tlog) if config.log.tlog else effective.folder / LOGS
    ports = list(dict.fromkeys(name for name in taken if name.startswith("/")))
    buses = sorted({f"/dev/i2c-{found[1]}" for name in taken if (found := _BUS.search(name))})
    trusts = {text: find_trust(parse_endpoint(text), config.signing.private) for text in config.endpoints}
    return {
        "pins": tuple(name for name in taken if name.startswith("GPIO ")),
        "simulated_pins": os.environ.get("GPIOZERO_PIN_FACTORY") == "mock",
        "gpio": tuple(_device(each) for each in sorted(glob.glob(GPIO_CHIPS))),
        "buses": tuple(_device(each) for each in buses),
        "serial": read_ports(ports),
        "signing": config.signing,
        "open_links": tuple(text for text, trust in trusts.items() if trust is None),
        "trusted_links": {text: trust.reason for text, trust in trusts.items() if trust is not None},
        "missing_interfaces": tuple(missing_interfaces(config.signing.private)),
        **_keys(effective.folder / FILE),
        "params": {name: effective.params[name] for name in ("FS_PI_TEMP", "LOG_FILE_MB_FREE")},
        "spaces": tuple(_space(each) for each in (effective.folder, logs)),
    }


def _keys(path: Path) -> dict[str, Any]:
    try:
        return {"keys": tuple(map(str, load_keys(path).keys))}
    except KeyFileError as error:
        return {"key_problem": str(error)}


def read_ports(paths: Iterable[str]) -> tuple[Device, ...]:
    """Return serial ports with the program that has each open."""
    wanted = list(paths)
    holders, consoles = find_holders(wanted), _consoles()
    return tuple(_device(each, holders.get(each, ""), Path(each).name in consoles) for each in wanted)


def _device(path: str, holder: str = "", console: bool = False) -> Device:
    try:
        number = os.stat(path).st_gid
    except OSError:
        return Device(path, present=False)
    group = str(number)
    with contextlib.suppress(KeyError):
        group = grp.getgrgid(number).gr_name
    return Device(path, True, group, os.access(path, os.R_OK | os.W_OK), holder, console)


def _consoles() -> set[str]:
    """Return the names of the ports on which the kernel writes its messages, links resolved."""
    with contextlib.suppress(OSError):
        words = COMMAND_LINE.read_text("utf-8", "replace").split()
        names = (word.removeprefix("console=").partition(",")[0] for word in words if word.startswith("console="))
        return {Path(os.path.realpath(f"/dev/{name}")).name for name in names}
    return set()


def _space(folder: Path) -> Space:
    """Return the free space of a folder that may not exist yet."""
    nearest = next(each for each in (folder, *folder.absolute().parents) if each.exists())
    return Space(str(folder), shutil.disk_usage(nearest).free)


def _user() -> str:
    with contextlib.suppress(KeyError):
        return pwd.getpwuid(os.geteuid()).pw_name
    return f"user {os.geteuid()}"


def read_clock() -> Clock:
    """Return year and state of the wall clock. adjtimex() without a mode only reads."""
    synchronized: bool | None = None
    with contextlib.suppress(OSError, AttributeError):
        state = ctypes.CDLL(None).adjtimex(ctypes.create_string_buffer(TIMEX_SIZE))
        synchronized = None if state < 0 else state != TIME_ERROR
    return Clock(time.gmtime().tm_year, synchronized)


def read_service() -> Mapping[str, str] | None:
    """Return the properties of the unit; None without systemd."""
    command = ["systemctl", "show", UNIT, f"--property={','.join(PROPERTIES)}"]
    try:
        answer = subprocess.run(command, capture_output=True, text=True, timeout=SYSTEMCTL_TIMEOUT, check=True)
    except (OSError, subprocess.SubprocessError):
        return None
    return parse_properties(answer.stdout)


def parse_properties(text: str) -> dict[str, str]:
    """Return the properties that `systemctl show` prints."""
    return {name: value for name, _, value in (line.partition("=") for line in text.splitlines()) if name}
