"""Starts the web server for the station of this process, and ends it."""

from __future__ import annotations

import importlib.util
import secrets
import socket
import subprocess
import sys
from collections.abc import Sequence

from groundstation.web.guard import HOSTS, TOKEN
from link.runtime.child_process import child_environment, end_process
from link.runtime.install_hint import install_command

DEFAULT_PORT = 8000

PACKAGES = ("textual_serve", "aiohttp")

END_WITHIN = 1.0
"""s for the server to end before it is killed."""


def missing_package() -> str | None:
    """Return the line for the user where the extra is not installed."""
    if all(importlib.util.find_spec(name) for name in PACKAGES):
        return None
    return f"--web needs the package textual-serve, which is not installed: {install_command('web')}"


class WebLaunch:
    """A port of this machine, a token for it, and the process that serves there. It ends with this process."""

    def __init__(self, port: int) -> None:
        """Listen on 127.0.0.1 only, so that a port in use is known before anything else starts. Raises OSError."""
        self._socket = socket.create_server((HOSTS[0], port))
        self._token = secrets.token_urlsafe(32)
        self.url = f"http://{HOSTS[0]}:{port}/?{TOKEN}={self._token}"
        """The address that lets a browser in."""
        self._process: subprocess.Popen[bytes] | None = None

    def start(self, arguments: Sequence[str]) -> None:
        """Start to serve; `arguments` are those of `mavhelm` for a tab. Raises OSError.

        Before this process forks: the port must be the server's alone.
        """
        descriptor = self._socket.fileno()
        self._process = subprocess.Popen(
            [sys.executable, "-P", "-m", "groundstation.web.server", f"--fd={descriptor}", "--", *arguments],
            stdin=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
            pass_fds=[descriptor],
            start_new_session=True,  # Ctrl-C is for the station, which ends this process
            env=child_environment(),
        )
        assert self._process.stdin is not None
        self._process.stdin.write(f"{self._token}\n".encode())  # not an argument, which every user of the machine sees
        self._process.stdin.flush()
        self._socket.close()

    def stop(self) -> None:
        """End the server: the terminals of its tabs are closed then, and their screens end, neutral."""
        self._socket.close()
        if self._process is not None and self._process.stdin is not None:
            self._process.terminate()  # another process may hold the pipe, of which the end would do as well
            end_process(self._process, END_WITHIN)
            self._process.stdin.close()
