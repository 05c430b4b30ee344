"""Errors of serial ports: one line that names the port and the remedy."""

from __future__ import annotations

import errno
import os

import pytest

from link.transport.serial_faults import serial_error_text


@pytest.mark.parametrize(
    ("number", "text"),
    [
        (errno.ENOENT, "/dev/ttyX is not there; is it plugged in?"),
        (errno.EBUSY, "another program uses /dev/ttyX (`fuser /dev/ttyX` shows which); stop it"),
        (errno.EACCES, "not allowed; add yourself to its group: sudo usermod -a -G dialout $USER, log in again"),
        (errno.ENOTTY, "/dev/ttyX is not a serial port"),
        (errno.ENOSPC, os.strerror(errno.ENOSPC)),
    ],
)
def test_an_error_names_the_port_and_the_remedy(number: int, text: str) -> None:
    assert serial_error_text("/dev/ttyX", OSError(number, os.strerror(number))) == text
