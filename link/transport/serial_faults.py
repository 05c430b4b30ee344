"""Error texts of serial ports, for links and for motor controllers."""

from __future__ import annotations

import errno

ABSENT_ERRNOS = (errno.ENOENT, errno.ENOTDIR, errno.ENODEV, errno.ENXIO, errno.EIO)
"""The port does not exist now; it may be plugged in later."""
_BUSY = (errno.EAGAIN, errno.EBUSY)
_FORBIDDEN = (errno.EACCES, errno.EPERM)


def serial_error_text(path: str, error: OSError) -> str:
    """Return why the port at `path` cannot be opened, and the remedy."""
    if error.errno in ABSENT_ERRNOS:
        return f"{path} is not there; is it plugged in?"
    if error.errno in _BUSY:
        return f"another program uses {path} (`fuser {path}` shows which); stop it"
    if error.errno in _FORBIDDEN:
        return "not allowed; add yourself to its group: sudo usermod -a -G dialout $USER, log in again"
    if error.errno in (None, errno.ENOTTY, errno.EISDIR):
        return f"{path} is not a serial port"
    return error.strerror or str(error)
