"""One program at a time for one set of motors, also where the hardware itself does not see to that (pins, I2C, PWM),
and one vehicle for one folder of kept things: two would write over each other's parameters and plans.

The locks are the kernel's, which forgets them with the process, however that ends. Stopping needs no lock.
"""

from __future__ import annotations

import contextlib
import errno
import fcntl
import hashlib
import os
import socket
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from vehicle.config.run_settings import SettingsError
from vehicle.motors import MotorError
from vehicle.motors.drivers import DRIVERS
from vehicle.motors.settings import port_name

SIMULATED = "simulated"


class InUseError(MotorError):
    """Another program has these motors."""


class MotorLock:
    """Held until `close`, or until the process ends."""

    def __init__(self, motors: Mapping[str, Any]) -> None:
        """`motors` is the table of settings. Raises InUseError, and MotorError where there are no locks."""
        self._socket: socket.socket | None = None
        name = _name(motors)
        if name is None:
            return
        holder = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM | socket.SOCK_CLOEXEC)
        try:
            holder.bind(name)
        except OSError as error:
            holder.close()
            if error.errno != errno.EADDRINUSE:
                raise MotorError(f"the lock of the motors: {error}") from error
            words = "the motors are in use by another vehicle; end it first, a service by: sudo systemctl stop rover"
            raise InUseError(words) from error
        self._socket = holder

    def close(self) -> None:
        """Let go."""
        if self._socket is not None:
            self._socket.close()
            self._socket = None


def _name(motors: Mapping[str, Any]) -> str | None:
    """The same for all names of one driver and of one serial port, and apart for each port.

    Simulated motors may run as often as you like, and a driver of your own may know better.
    """
    driver = motors["driver"]
    if driver == SIMULATED or driver not in DRIVERS:
        return None
    port = port_name(str(motors["port"])) if "port" in motors else ""
    # Hashed: the kernel takes 107 bytes, and a name in /dev/serial/by-id has 60 and more.
    return f"\0mavhelm motors {hashlib.sha256(f'{DRIVERS[driver].path} {port}'.encode()).hexdigest()}"


@contextlib.contextmanager
def lock_state_folder(folder: Path) -> Iterator[None]:
    """Hold `folder`, which is made where it is missing, to the end. Raises SettingsError where another vehicle does.

    One that cannot be made or opened is no matter here: whoever writes into it says so.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
    except OSError:
        yield
        return
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        os.close(descriptor)
        words = "is in use by another vehicle; end that, or name another folder with --state"
        raise SettingsError(f"state folder {folder} {words}") from None
    except OSError:  # a file system without locks
        pass
    try:
        yield
    finally:
        os.close(descriptor)
