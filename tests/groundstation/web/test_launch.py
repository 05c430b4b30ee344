"""The process of the web server: what it gets, what it does not say, and how it ends."""

from __future__ import annotations

import http.client
import os
import pty
import re
import runpy
import signal
import socket
import sys
from collections.abc import Iterator
from contextlib import closing, suppress
from pathlib import Path
from urllib.parse import urlsplit

import pytest

pytest.importorskip("aiohttp", reason="the extra [web] is not installed")
from groundstation.cli.local.serve import build_parser
from groundstation.web import launch as launching
from groundstation.web.launch import WebLaunch, missing_package
from link.runtime.child_process import ROOT
from tests.groundstation.screen import children, running
from tests.ports import free_port
from tests.waits import PATIENCE, wait_until


@pytest.fixture
def launch() -> Iterator[WebLaunch]:
    launch = WebLaunch(free_port())
    try:
        yield launch
    finally:
        launch.stop()


def page(launch: WebLaunch, query: str | None = None) -> int:
    """The status of the first page, with the token if no other query is given."""
    place = urlsplit(launch.url)
    assert place.hostname is not None
    with closing(http.client.HTTPConnection(place.hostname, place.port, timeout=PATIENCE)) as connection:
        connection.request("GET", f"/?{place.query if query is None else query}")
        with connection.getresponse() as response:
            return response.status


def is_open(launch: WebLaunch) -> bool:
    place = urlsplit(launch.url)
    with suppress(ConnectionRefusedError), socket.create_connection((place.hostname, place.port), PATIENCE):
        return True
    return False


def started(launch: WebLaunch, *arguments: str) -> int:
    """Start a server; return its process id when it serves."""
    before = set(children(os.getpid()))
    launch.start(arguments)
    assert page(launch) == 200
    [pid] = set(children(os.getpid())) - before
    return pid


def test_the_process_serves_this_machine_and_keeps_the_token(
    launch: WebLaunch, capfd: pytest.CaptureFixture[str]
) -> None:
    assert re.fullmatch(r"http://127\.0\.0\.1:\d+/\?token=[\w-]{43}", launch.url)
    pid = started(launch, "--watch")
    assert page(launch, "token=wrong") == 401
    process = Path(f"/proc/{pid}")
    token = urlsplit(launch.url).query.removeprefix("token=")
    assert process.joinpath("cmdline").read_bytes().endswith(b"\0--\0--watch\0")
    for name in ("cmdline", "environ"):
        assert token.encode() not in process.joinpath(name).read_bytes()
    assert f"PYTHONPATH={ROOT}".encode() in process.joinpath("environ").read_bytes()
    assert os.readlink(process / "fd/1") == "/dev/null" != os.readlink("/proc/self/fd/1")
    assert os.getsid(pid) == pid, "Ctrl-C is for the station, which ends this process"
    with pytest.raises(ConnectionRefusedError):
        socket.create_connection(("127.0.0.2", urlsplit(launch.url).port or 0), PATIENCE)


def test_each_start_has_another_token(launch: WebLaunch) -> None:
    other = WebLaunch(free_port())
    other.stop()
    assert urlsplit(launch.url).query != urlsplit(other.url).query


def test_a_stop_ends_the_process_at_once(launch: WebLaunch) -> None:
    pid = started(launch)
    launch.stop()
    assert not running(pid)
    assert launch._process is not None
    assert launch._process.returncode == -signal.SIGTERM
    assert not is_open(launch)
    launch.stop()


def test_a_process_that_hangs_is_killed(launch: WebLaunch) -> None:
    pid = started(launch)
    os.kill(pid, signal.SIGSTOP)
    launch.stop()
    assert not running(pid)
    assert pid not in children(os.getpid())


def test_the_port_is_the_process_own(launch: WebLaunch) -> None:
    """When it is killed, nobody waits for an answer."""
    pid = started(launch)
    os.kill(pid, signal.SIGKILL)
    wait_until(lambda: not running(pid))
    assert not is_open(launch)


def test_the_process_ends_when_nobody_wants_it(launch: WebLaunch) -> None:
    pid = started(launch)
    assert launch._process is not None
    assert launch._process.stdin is not None
    launch._process.stdin.close()
    wait_until(lambda: not running(pid))
    assert launch._process.wait(PATIENCE) == 0


def test_a_port_that_is_taken_is_known_at_once() -> None:
    first = WebLaunch(free_port())
    with pytest.raises(OSError, match="in use"):
        WebLaunch(urlsplit(first.url).port or 0)
    first.stop()
    assert not is_open(first), "nothing was started"
    WebLaunch(urlsplit(first.url).port or 0).stop()


@pytest.mark.parametrize(
    ("packages", "missing"),
    [
        (("aiohttp", "textual"), False),
        (("no_such_package", "aiohttp"), True),
        (("aiohttp", "no_such_package"), True),
        (("no_such_package",), True),
    ],
)
def test_a_missing_package_is_one_line(
    packages: tuple[str, ...], missing: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(launching, "PACKAGES", packages)
    line = missing_package()
    assert (line is not None) == missing
    assert line is None or re.fullmatch(r"--web needs the package textual-serve, .*mavhelm\[web\]'?", line)


def test_the_port_is_8000() -> None:
    assert build_parser().parse_args(["--web"]).port == 8000


def test_the_terminal_becomes_that_of_the_program() -> None:
    """So that its end is SIGHUP. In a fork, which has this process's modules."""
    ours, theirs = pty.openpty()
    child = os.fork()
    if child == 0:
        code = 1
        with suppress(BaseException):
            code = _in_terminal(theirs)
        os._exit(code)
    os.close(theirs)
    drawn = b""
    with suppress(OSError):  # EIO: the end
        while data := os.read(ours, 4096):
            drawn += data
    os.close(ours)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
    assert drawn.startswith(b"mavhelm 0.")


def _in_terminal(terminal: int) -> int:
    """Run the program with a terminal as its standard input; return 0 if it is the controlling one."""
    os.setsid()
    os.dup2(terminal, 0)
    os.dup2(terminal, 1)
    sys.stdout = os.fdopen(1, "w")
    sys.argv = ["controlling_terminal", "--version"]
    module = "groundstation.web.controlling_terminal"
    sys.modules.pop(module, None)  # runpy warns of a module that was imported
    with suppress(SystemExit):
        runpy.run_module(module, run_name="__main__")
    sys.stdout.flush()
    return 0 if os.tcgetpgrp(0) == os.getpid() else 1  # raises OSError at any other terminal
