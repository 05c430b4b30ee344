"""Other users of this machine connect to the web server and say nothing, or rubbish: the owner's page still opens."""

from __future__ import annotations

import asyncio
import logging

import pytest

pytest.importorskip("aiohttp", reason="the extra [web] is not installed")
from groundstation.web.door import Door, FewLines
from tests.groundstation.web.served import answer_on, read_until, rest_of, served

REFUSED = {
    "no token": "GET / HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n\r\n",
    "another host": "GET / HTTP/1.1\r\nHost: evil.example\r\n\r\n",
    "a body that never comes": "POST / HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nContent-Length: 100\r\n\r\n",
    "rubbish": "\x16\x03\x01\r\n\r\n",
}


def is_open(reader: asyncio.StreamReader) -> bool:
    return reader.exception() is None and not reader.at_eof()


async def test_of_many_silent_connections_the_oldest_go() -> None:
    async with served(within=60.0) as server:
        silent = [await server.connect() for _ in range(200)]
        assert (await server.get("/"))[0] == 200
        assert await asyncio.gather(*map(rest_of, silent[:169])) == [b""] * 169
        assert all(map(is_open, silent[169:]))


async def test_32_connections_may_take_their_time() -> None:
    async with served(within=60.0) as server:
        slow = [await server.connect("GET / HTTP/1.1\r\n") for _ in range(32)]
        for each, writer in zip(slow, server.writers, strict=True):
            writer.write(server.request().partition("\r\n")[2].encode())
            assert await answer_on(each) == 200
        first, *others = [await server.connect() for _ in range(33)]
        assert await rest_of(first) == b""
        assert all(map(is_open, others))


@pytest.mark.parametrize("what", REFUSED)
async def test_who_is_refused_keeps_no_connection(what: str) -> None:
    """Else a thousand refused requests, repeated now and then, use up the descriptors as silent connections would."""
    async with served(within=60.0) as server:
        first = await server.connect("GET / HTTP/1.1\r\n")
        for _ in range(31):
            assert (await rest_of(await server.connect(REFUSED[what].format(port=server.port)))) != b""
        await server.connect()
        server.writers[0].write(server.request().partition("\r\n")[2].encode())
        assert await answer_on(first) == 200, "those that have ended take no place"


@pytest.mark.parametrize("count", [1, 2])
async def test_refused_connections_that_stay_open_give_way(count: int) -> None:
    """The client does not read, and sends a part of a body now and then."""
    async with served(within=60.0) as server:
        body = REFUSED["a body that never comes"].format(port=server.port)
        held = [await server.connect(body * count) for _ in range(40)]
        answers = await asyncio.gather(*map(rest_of, held[:8]))
        assert all(answer == b"" or answer.startswith(b"HTTP/1.1 401 ") for answer in answers)
        assert (await server.get("/"))[0] == 200


@pytest.mark.parametrize("said", ["", "GET / HTTP/1.1\r\nHost: ", "\r\n\r\n"])
async def test_a_connection_that_asks_nothing_ends_in_time(said: str) -> None:
    async with served(within=0.2) as server:
        tab = await server.tab()
        await read_until(tab, "ready")
        began = asyncio.get_running_loop().time()
        assert not await rest_of(await server.connect(said))
        assert asyncio.get_running_loop().time() - began > 0.15
        await tab.send_json(["stdin", "still here\r"])
        await read_until(tab, "got still here")


async def test_a_connection_that_was_admitted_is_not_counted() -> None:
    async with served(within=60.0) as server:
        ours = await server.connect(server.request())
        assert await answer_on(ours) == 200
        for _ in range(40):
            await server.connect()
        server.writers[0].write(server.request().encode())
        assert await answer_on(ours) == 200


async def test_a_connection_that_was_admitted_ends_when_idle() -> None:
    async with served(within=0.2) as server:
        ours = await server.connect(server.request())
        assert await answer_on(ours) == 200
        assert await rest_of(ours) == b""


async def test_a_slow_answer_is_not_cut() -> None:
    """The time is for the request."""
    async with served(within=0.2) as server:
        tab = await server.tab()
        await rest_of(await server.connect())
        await read_until(tab, "ready")


async def test_a_request_without_a_connection_is_nothing() -> None:
    """A browser may be gone before its request is looked at."""
    door = Door(asyncio.Protocol)
    door.admit(None)


def test_the_log_takes_20_lines_a_minute() -> None:
    now = [100.0]
    few = FewLines(lambda: now[0])
    record = logging.makeLogRecord({})
    assert [few.filter(record) for _ in range(50)] == [True] * 20 + [False] * 30
    now[0] = 159.0
    assert not few.filter(record)
    now[0] = 160.0
    assert [few.filter(record) for _ in range(50)] == [True] * 20 + [False] * 30


@pytest.mark.parametrize(
    ("error", "written"),
    [
        (KeyError("theirs"), "of 127.0.0.1: KeyError"),
        (ValueError("ours"), "of 127.0.0.1\nValueError: ours"),
        (None, "of 127.0.0.1"),
    ],
)
def test_an_error_of_a_stranger_is_one_line(error: Exception | None, written: str) -> None:
    info = None if error is None else (type(error), error, None)
    record = logging.LogRecord("aiohttp.server", logging.ERROR, "", 0, "of %s", ("127.0.0.1",), info)
    assert FewLines(brief=(KeyError,)).filter(record)
    assert logging.Formatter().format(record) == written
