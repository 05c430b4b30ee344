"""Other users of this machine connect to the web server and say nothing, or rubbish: the owner's page still opens."""

from __future__ import annotations

import http.client
import logging
import socket
import time
from collections.abc import Iterator
from contextlib import ExitStack, closing
from urllib.parse import urlsplit

import pytest

pytest.importorskip("aiohttp", reason="the extra [web] is not installed")
from groundstation.web.door import FewLines
from groundstation.web.launch import WebLaunch
from tests.ports import free_port

PATIENCE = 30.0


@pytest.fixture
def launch() -> Iterator[WebLaunch]:
    launch = WebLaunch(free_port())
    launch.start([])
    try:
        yield launch
    finally:
        launch.stop()


def page(launch: WebLaunch) -> int:
    """The status of the first page with the token."""
    place = urlsplit(launch.url)
    assert place.hostname is not None
    with closing(http.client.HTTPConnection(place.hostname, place.port, timeout=PATIENCE)) as connection:
        connection.request("GET", f"/?{place.query}")
        with connection.getresponse() as response:
            return response.status


def silent(launch: WebLaunch, stack: ExitStack) -> socket.socket:
    place = urlsplit(launch.url)
    found = stack.enter_context(socket.create_connection((place.hostname, place.port), PATIENCE))
    found.settimeout(PATIENCE)
    return found


def has_ended(connection: socket.socket) -> bool:
    """Whether the server ends a connection, which is waited for."""
    try:
        return connection.recv(1) == b""
    except ConnectionResetError:
        return True


def test_of_many_silent_connections_the_oldest_go(launch: WebLaunch) -> None:
    with ExitStack() as stack:
        assert page(launch) == 200
        connections = [silent(launch, stack) for _ in range(200)]
        assert page(launch) == 200
        assert all(has_ended(each) for each in connections[:168])


def test_a_connection_that_asks_nothing_ends_after_5_s(launch: WebLaunch) -> None:
    with ExitStack() as stack:
        assert page(launch) == 200
        begun = time.monotonic()
        slow = silent(launch, stack)
        slow.sendall(b"GET / HTTP/1.1\r\nHost: ")
        assert has_ended(slow)
        assert time.monotonic() - begun > 4.0
        assert page(launch) == 200


def test_rubbish_does_not_fill_the_log(launch: WebLaunch, capfd: pytest.CaptureFixture[str]) -> None:
    assert page(launch) == 200
    for _ in range(300):
        with ExitStack() as stack:
            rubbish = silent(launch, stack)
            rubbish.sendall(b"\x16\x03\x01\x02\x00rubbish\r\n\r\n")
            rubbish.recv(1)
    assert page(launch) == 200
    assert len(capfd.readouterr().err) < 100_000


def test_the_log_takes_20_lines_a_minute() -> None:
    now = [0.0]
    few = FewLines(lambda: now[0])
    record = logging.makeLogRecord({})
    assert [few.filter(record) for _ in range(50)].count(True) == 20
    now[0] = 59.0
    assert not few.filter(record)
    now[0] = 60.0
    assert few.filter(record)
