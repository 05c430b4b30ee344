"""Starts a process of groundstation/host, which imports its modules while its arguments are still being made."""

from __future__ import annotations

import os
import socket
import subprocess
from collections.abc import Sequence

from link.runtime.child_process import end_process, start_module

STATION, REPLAY = "groundstation.host.station_process", "groundstation.host.replay_process"
"""The modules that run as such a process."""

MAX_ARGUMENTS = 1 << 16
"""Bytes of all arguments."""
_SEPARATOR = b"\0"


class ArgumentsError(ValueError):
    """These cannot be arguments of a process; the message is one line for the user."""


class HostProcess:
    """The process and our end of the pipe to it, which is closed by end() unless release() was called before."""

    def __init__(self, module: str) -> None:
        """Start it. Raises OSError."""
        self._released = False
        self.pipe, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        try:
            with theirs:
                self.process = start_module(module, [f"--fd={theirs.fileno()}"], pass_fds=[theirs.fileno()])
        except OSError:
            self.pipe.close()
            raise

    def send_arguments(self, arguments: Sequence[str]) -> None:
        """Send its command line, the first packet. Raises ArgumentsError; OSError if the process has ended."""
        encoded = [os.fsencode(each) for each in arguments]
        if any(_SEPARATOR in each for each in encoded):
            raise ArgumentsError("a setting has a zero byte in it")
        packet = _SEPARATOR.join(encoded)
        if len(packet) > MAX_ARGUMENTS:
            raise ArgumentsError(f"the settings and endpoints have {len(packet)} bytes, more than {MAX_ARGUMENTS}")
        self.pipe.send(packet)

    def release(self) -> tuple[socket.socket, subprocess.Popen[bytes]]:
        """Return the pipe and the process, which are the caller's from now on."""
        self._released = True
        return self.pipe, self.process

    def end(self, timeout: float = 0.0) -> None:
        """Close the pipe; kill the process if it still runs after `timeout` s."""
        if not self._released:
            self._released = True
            self.pipe.close()
            end_process(self.process, timeout)


def read_arguments(pipe: socket.socket) -> list[str] | None:
    """Return the arguments that the other end sends first; None if it has ended. Waits for them."""
    try:
        packet = pipe.recv(MAX_ARGUMENTS)
    except OSError:
        return None
    return [os.fsdecode(each) for each in packet.split(_SEPARATOR)] if packet else None
