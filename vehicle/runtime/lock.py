"""Locks: one program at a time for a set of motors, and one vehicle for a state folder.

The hardware (pins, I2C, PWM) does not prevent two programs from driving the same motors, and two vehicles would
overwrite each other's parameters and plans. The kernel releases the locks when the process ends, however it ends.
Stopping motors needs no lock.
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
    """Another program uses these motors."""


class MotorLock:
    """A lock on motors, held until `close` or until the process ends."""

    def __init__(self, motors: Mapping[str, Any]) -> None:
        """Acquire the lock for the table [motors]. Raises InUseError, and MotorError if locks are not supported."""
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
            raise InUseError(
                "the motors are in use by another vehicle; stop it first, a service with: sudo systemctl stop rover"
            ) from error
        self._socket = holder

    def close(self) -> None:
        """Release the lock."""
        if self._socket is not None:
            self._socket.close()
            self._socket = None


def _name(motors: Mapping[str, Any]) -> str | None:
    """Return the name of the lock: one for each driver class and serial port. None for motors without a lock.

    Simulated motors need no lock; a driver from outside has to protect its hardware itself.
    """
    driver = motors["driver"]
    if driver == SIMULATED or driver not in DRIVERS:
        return None
    port = port_name(str(motors["port"])) if "port" in motors else ""
    # Hashed: the kernel accepts 107 bytes, and a name in /dev/serial/by-id has 60 and more.
    return f"\0mavhelm motors {hashlib.sha256(f'{DRIVERS[driver].path} {port}'.encode()).hexdigest()}"


@contextlib.contextmanager
def lock_state_folder(folder: Path) -> Iterator[None]:
    """Lock `folder`, which is created if needed. Raises SettingsError if another vehicle uses it.

    A folder that cannot be created or opened is ignored here: writing to it reports the error.
    """
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
    except OSError:
        yield
        return
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        os.close(descriptor)
        raise SettingsError(
            f"state folder {folder} is in use by another vehicle; stop it, or set another folder with --state"
        ) from None
    except OSError:  # the file system does not support locks
        pass
    try:
        yield
    finally:
        os.close(descriptor)
