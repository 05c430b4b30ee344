"""Programs that are forked from a process which has imported their modules: a start takes 20 ms in place of 500.

A forked program has arguments, environment, folder and standard streams of its own, and ends with its own exit code.
`Forks` is that process, which listens on a socket of the file system. Each connection is one program: it is told its
process id and its exit code there, and killed when the connection closes.

What Python does before the first line of a program, such as a warning of an import, only a real start shows.
"""

from __future__ import annotations

import atexit
import gc
import io
import json
import logging
import os
import random
import runpy
import selectors
import signal
import socket
import subprocess
import sys
import tempfile
import traceback
from collections.abc import Mapping, Sequence
from contextlib import suppress
from importlib import import_module
from pathlib import Path
from typing import Any

from link.runtime import without_openssl
from tests.waits import PATIENCE, wait_until

PROGRAMS = (
    "groundstation.cli.console", "groundstation.cli.main", "groundstation.cli.local.replay",
    "groundstation.export.exporter", "groundstation.verbs.main", "groundstation.verbs.performing",
    "groundstation.verbs.session.running", "groundstation.verbs.session.session", "link.bridge.bridge",
    "vehicle.cli.main",
)  # fmt: skip
"""What is imported before the first fork. All else a program imports itself."""
LARGEST = 65536
"""Bytes of a request at most."""
STREAMS = 3


class Forks:
    """Starts programs."""

    def __init__(self) -> None:
        self._folder = tempfile.TemporaryDirectory(prefix="mavhelm-forks-")
        self.address = str(Path(self._folder.name) / "socket")
        """Where it listens."""
        command = [sys.executable, "-m", "tests.forked", self.address]
        self._process = subprocess.Popen(command, stdin=subprocess.PIPE, cwd=Path(__file__).parents[1])
        wait_until(Path(self.address).exists, "the process that forks listens")

    def start(
        self, words: Sequence[str], folder: Path, environment: Mapping[str, str], streams: Sequence[int]
    ) -> Forked:
        """Start `python -m words` with descriptors for stdin, stdout and stderr, which stay open here."""
        connection = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        connection.connect(self.address)
        request = json.dumps([list(words), str(folder), dict(environment)]).encode()
        assert len(request) < LARGEST
        socket.send_fds(connection, [request], streams)
        return Forked(words, connection)

    def close(self) -> None:
        """End the process that forks, and all programs."""
        assert self._process.stdin is not None
        self._process.stdin.close()
        self._process.wait(PATIENCE)
        self._folder.cleanup()


class Forked:
    """A program that runs."""

    def __init__(self, words: Sequence[str], connection: socket.socket) -> None:
        self.words = words
        self._connection = connection
        connection.settimeout(PATIENCE)
        self.pid = int(connection.recv(LARGEST))

    def wait(self) -> int:
        """Wait until it has ended; return its exit code."""
        with self._connection:
            return int(self._connection.recv(LARGEST))


class Server:
    """Forks a program for each connection."""

    def __init__(self, address: str) -> None:
        self._listener = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self._ended, wakes = socket.socketpair()
        for each in (self._ended, wakes):
            each.setblocking(False)
        signal.signal(signal.SIGCHLD, lambda *_: None)
        signal.set_wakeup_fd(wakes.fileno())
        self._wakes = wakes
        self._running: dict[int, socket.socket] = {}
        """Process id -> its connection."""
        self._selector = selectors.DefaultSelector()
        for source in (self._listener, self._ended, sys.stdin):
            self._selector.register(source, selectors.EVENT_READ)
        self._listener.bind(f"{address}.new")
        self._listener.listen(socket.SOMAXCONN)
        os.rename(f"{address}.new", address)  # whoever sees it can connect

    def serve(self) -> None:
        """Fork until stdin closes; then kill what runs."""
        while True:
            for key, _ in self._selector.select():
                if key.fileobj is sys.stdin:
                    for pid in self._running:
                        os.kill(pid, signal.SIGKILL)
                    return
                if key.fileobj is self._listener:
                    self._fork()
                elif key.fileobj is self._ended:
                    self._ended.recv(LARGEST)
                    self._reap()
                else:
                    self._kill(key.fileobj)

    def _fork(self) -> None:
        connection, _ = self._listener.accept()
        data, streams, _, _ = socket.recv_fds(connection, LARGEST, STREAMS)
        if len(streams) < STREAMS:
            connection.close()
            return
        child = os.fork()
        if child == 0:
            self._forget(connection)
            words, folder, environment = json.loads(data)
            _become(words, folder, environment, streams)
        for each in streams:
            os.close(each)
        self._running[child] = connection
        self._selector.register(connection, selectors.EVENT_READ)
        with suppress(OSError):
            connection.send(str(child).encode())

    def _forget(self, connection: socket.socket) -> None:
        """Close in the child what is its parent's."""
        signal.set_wakeup_fd(-1)
        signal.signal(signal.SIGCHLD, signal.SIG_DFL)
        self._selector.close()
        for each in (connection, self._listener, self._ended, self._wakes, *self._running.values()):
            each.close()

    def _reap(self) -> None:
        while self._running:
            child, status = os.waitpid(-1, os.WNOHANG)
            if child == 0:
                return
            connection = self._running.pop(child)
            with suppress(KeyError):
                self._selector.unregister(connection)
            with suppress(OSError):
                connection.send(str(os.waitstatus_to_exitcode(status)).encode())
            connection.close()

    def _kill(self, connection: Any) -> None:
        """End a program for which nobody waits any more."""
        self._selector.unregister(connection)
        for pid, its in self._running.items():
            if its is connection:
                os.kill(pid, signal.SIGKILL)


def _become(words: list[str], folder: str, environment: dict[str, str], streams: list[int]) -> None:
    """Run a program as `python -m` does, and end this process."""
    for standard, given in enumerate(streams):
        os.dup2(given, standard)
        os.close(given)
    sys.stdin = sys.__stdin__ = _text(0, "r")  # type: ignore[misc]
    sys.stdout = sys.__stdout__ = _text(1, "w")  # type: ignore[misc]
    sys.stderr = sys.__stderr__ = _text(2, "w", errors="backslashreplace")  # type: ignore[misc]
    os.chdir(folder)
    os.environ.clear()
    os.environ.update(environment)
    sys.argv[1:] = words[1:]
    random.seed()
    code = _run(words[0])
    atexit._run_exitfuncs()
    logging.shutdown()
    with suppress(BrokenPipeError):
        sys.stdout.flush()
        sys.stderr.flush()
    os._exit(code)


def _text(descriptor: int, mode: str, errors: str = "strict") -> io.TextIOWrapper:
    buffering = 1 if descriptor == 2 or os.isatty(descriptor) else -1
    # Until the end of the process.
    opened = open(descriptor, mode, buffering=buffering, encoding="utf-8", errors=errors, closefd=False)  # noqa: SIM115
    assert isinstance(opened, io.TextIOWrapper)
    return opened


def _run(module: str) -> int:
    try:
        runpy.run_module(module, run_name="__main__", alter_sys=True)
    except SystemExit as end:
        if end.code is None or isinstance(end.code, int):
            return end.code or 0
        print(end.code, file=sys.stderr)
        return 1
    except BaseException:
        traceback.print_exc()
        return 1
    return 0


if __name__ == "__main__":
    without_openssl.load()
    for name in PROGRAMS:
        import_module(name)
    gc.freeze()
    Server(sys.argv[1]).serve()
