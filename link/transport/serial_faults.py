"""Why a serial port cannot be opened, in the words of somebody who can mend it; for links and for motor controllers."""

from __future__ import annotations

import errno

ABSENT_ERRNOS = (errno.ENOENT, errno.ENOTDIR, errno.ENODEV, errno.ENXIO, errno.EIO)
"""There is no such port now; it may be plugged in later."""
_BUSY = (errno.EAGAIN, errno.EBUSY)
_FORBIDDEN = (errno.EACCES, errno.EPERM)


def serial_error_text(path: str, error: OSError) -> str:
    """What is wrong with the port at `path`, and what to do."""
    if error.errno in ABSENT_ERRNOS:
        return f"{path} is not there; is it plugged in?"
    if error.errno in _BUSY:
        return f"another program uses {path} (`fuser {path}` says which); stop it"
    if error.errno in _FORBIDDEN:
        return "not allowed; add yourself to its group: sudo usermod -a -G dialout $USER, log in again"
    if error.errno in (None, errno.ENOTTY, errno.EISDIR):
        return f"{path} is no serial port"
    return error.strerror or str(error)
