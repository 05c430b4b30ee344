"""Programs that are forked from a process which has imported their modules: a start takes 20 ms in place of 500.

A forked program has arguments, environment, folder and standard streams of its own, and ends with its own exit code.
What Python does before the first line of a program, such as a warning of an import, only a real start shows.
"""

from __future__ import annotations

import atexit
import gc
import io
import json
import logging
import os
import runpy
import socket
import subprocess
import sys
import traceback
from collections.abc import Mapping, Sequence
from importlib import import_module
from pathlib import Path

from tests.waits import PATIENCE

PROGRAMS = (
    "groundstation.cli.console", "groundstation.cli.main", "groundstation.cli.local.replay",
    "groundstation.export.exporter", "groundstation.verbs.main", "groundstation.verbs.session.session",
    "link.bridge.bridge", "vehicle.cli.main",
)  # fmt: skip
"""What is imported before the first fork. All else a program imports itself."""
LARGEST = 65536
"""Bytes of a request at most."""


class Forks:
    """Starts programs, one after the other."""

    def __init__(self) -> None:
        self._socket, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self._socket.settimeout(PATIENCE)
        command = [sys.executable, "-m", "tests.forked", str(theirs.fileno())]
        self._process = subprocess.Popen(command, pass_fds=[theirs.fileno()], cwd=Path(__file__).parents[1])
        theirs.close()

    def start(self, words: Sequence[str], folder: Path, environment: Mapping[str, str], streams: Sequence[int]) -> None:
        """Start `python -m words` with descriptors for stdin, stdout and stderr, which stay open here."""
        request = json.dumps([list(words), str(folder), dict(environment)]).encode()
        assert len(request) < LARGEST
        socket.send_fds(self._socket, [request], streams)

    def ended(self) -> int:
        """Wait until it has ended; return its exit code."""
        return int(self._socket.recv(LARGEST))

    def close(self) -> None:
        """End the process that forks."""
        self._socket.close()
        self._process.kill()
        self._process.wait(PATIENCE)


def serve(requests: socket.socket) -> None:
    """Fork a program for each request, wait for its end, and answer with its exit code."""
    while True:
        data, streams, _, _ = socket.recv_fds(requests, LARGEST, 3)
        if not data:
            return
        child = os.fork()
        if child == 0:
            requests.close()
            words, folder, environment = json.loads(data)
            _become(words, folder, environment, streams)
        for each in streams:
            os.close(each)
        _, status = os.waitpid(child, 0)
        requests.send(str(os.waitstatus_to_exitcode(status)).encode())


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
    code = _run(words[0])
    atexit._run_exitfuncs()
    logging.shutdown()
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
    for name in PROGRAMS:
        import_module(name)
    gc.freeze()
    serve(socket.socket(fileno=int(sys.argv[1])))
