"""Starts a process of groundstation/host, which imports its modules while its arguments are still being made."""

from __future__ import annotations

import contextlib
import os
import socket
import subprocess
from collections.abc import Sequence

from link.runtime.child_process import end_process, start_module
from link.runtime.local_socket import open_pair

STATION, REPLAY = "groundstation.host.station_process", "groundstation.host.replay_process"
"""The modules that run as such a process."""

MAX_ARGUMENTS = 1 << 16
"""Bytes of all arguments."""
_SEPARATOR = b"\0"


class ArgumentsError(ValueError):
    """These cannot be arguments of a process; the message is one line for the user."""


class HostProcess:
    """The process and our ends of the pipes to it, which are closed by end() unless release() was called before.

    `watchdog` leads to the watchdog of a station. It is a pipe of its own: on a stream, two processes that write to one
    screen could break the packets of each other.
    """

    def __init__(self, module: str) -> None:
        """Start it. Raises OSError."""
        self._released = False
        with contextlib.ExitStack() as stack:
            self.pipe, theirs = open_pair()
            stack.enter_context(theirs)
            descriptors = {"--fd": theirs.fileno()}
            self.watchdog = None
            if module == STATION:
                self.watchdog, guards = open_pair()
                stack.enter_context(guards)
                descriptors["--watchdog-fd"] = guards.fileno()
            try:
                options = [f"{name}={number}" for name, number in descriptors.items()]
                self.process = start_module(module, options, pass_fds=list(descriptors.values()))
            except OSError:
                self._close()
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

    def release(self) -> tuple[socket.socket, socket.socket | None, subprocess.Popen[bytes]]:
        """Return the pipe, that to the watchdog and the process, which are the caller's from now on."""
        self._released = True
        return self.pipe, self.watchdog, self.process

    def end(self, timeout: float = 0.0) -> None:
        """Close the pipe; kill the process if it still runs after `timeout` s."""
        if not self._released:
            self._released = True
            self._close()
            end_process(self.process, timeout)

    def _close(self) -> None:
        self.pipe.close()
        if self.watchdog is not None:
            self.watchdog.close()


def read_arguments(pipe: socket.socket) -> list[str] | None:
    """Return the arguments that the other end sends first; None if it has ended. Waits for them."""
    try:
        packet = pipe.recv(MAX_ARGUMENTS)
    except OSError:
        return None
    return [os.fsdecode(each) for each in packet.split(_SEPARATOR)] if packet else None
