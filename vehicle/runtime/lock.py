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
import sys
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

from vehicle.config.run_settings import SettingsError
from vehicle.motors import MotorError
from vehicle.motors.drivers import DRIVERS
from vehicle.motors.settings import port_name

SIMULATED = "simulated"

HAS_ABSTRACT_NAMES = sys.platform == "linux"
LOCK_FOLDER = Path("/tmp")
"""For the files that are locked where sockets have no abstract names; all users share it."""


class InUseError(MotorError):
    """Another program uses these motors."""


class MotorLock:
    """A lock on motors, held until `close` or until the process ends."""

    def __init__(self, motors: Mapping[str, Any]) -> None:
        """Acquire the lock for the table [motors]. Raises InUseError, and MotorError if locks are not supported."""
        self._release: Callable[[], None] | None = None
        name = _name(motors)
        if name is None:
            return
        try:
            self._release = _lock_name(name) if HAS_ABSTRACT_NAMES else _lock_file(LOCK_FOLDER / f"{name}.lock")
        except OSError as error:
            if error.errno not in (errno.EADDRINUSE, errno.EWOULDBLOCK):
                raise MotorError(f"the lock of the motors: {error}") from error
            raise InUseError(
                "the motors are in use by another vehicle; stop it first, a service with: sudo systemctl stop rover"
            ) from error

    def close(self) -> None:
        """Release the lock."""
        if self._release is not None:
            self._release()
            self._release = None


def _lock_name(name: str) -> Callable[[], None]:
    """Take an abstract name of a socket, which is no file; return what releases it. Raises OSError."""
    holder = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
    try:
        holder.bind(f"\0{name}")
    except OSError:
        holder.close()
        raise
    return holder.close


def _lock_file(path: Path) -> Callable[[], None]:
    """Lock a file, which all users may open; return what releases it. Raises OSError."""
    descriptor = os.open(path, os.O_RDONLY | os.O_CREAT | os.O_NOFOLLOW | os.O_CLOEXEC, 0o644)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        os.close(descriptor)
        raise
    return lambda: os.close(descriptor)


def _name(motors: Mapping[str, Any]) -> str | None:
    """Return the name of the lock: one for each driver class and serial port. None for motors without a lock.

    Simulated motors need no lock; a driver from outside has to protect its hardware itself.
    """
    driver = motors["driver"]
    if driver == SIMULATED or driver not in DRIVERS:
        return None
    port = port_name(str(motors["port"])) if "port" in motors else ""
    # Hashed: the kernel accepts 107 bytes, and a name in /dev/serial/by-id has 60 and more.
    return f"mavhelm motors {hashlib.sha256(f'{DRIVERS[driver].path} {port}'.encode()).hexdigest()}"


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
