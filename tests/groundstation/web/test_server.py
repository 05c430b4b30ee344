"""The web server in this process: who is let in, what a tab may send, and what ends when a tab or the server ends."""

from __future__ import annotations

import asyncio
import logging
import os
import re
import socket
import sys
from collections.abc import Iterator
from contextlib import suppress

import pytest

pytest.importorskip("aiohttp", reason="the extra [web] is not installed")
import aiohttp

from groundstation.web import server as serving
from groundstation.web.server import FILES, _number, main
from tests.groundstation.screen import running
from tests.groundstation.web.served import PATIENCE, TOKEN, Served, end_of, read_until, rest_of, served
from tests.waits import until

PAGES = ("/", *(f"/{name}" for name in FILES), "/static/js/textual.js", "/static/css/xterm.css")
PASTE = (
    "sh", "-c", "stty raw -echo; echo ready; head -c 60000 | tr -d x | wc -c; cat",
)  # fmt: skip
"""A program that counts what is not "x" among 60000 characters."""


@pytest.mark.parametrize(
    ("name", "value"), [("MAX_TABS", 7), ("MAX_MESSAGE", 65_536), ("HEARTBEAT", 4.0), ("SHUTDOWN", 1.0)]
)
def test_a_bound_is_this_number(name: str, value: float) -> None:
    assert getattr(serving, name) == value


def test_numbers_of_an_address() -> None:
    texts = (None, "", "-1", "1e3", "\u0663", "999999", "100", "99999")
    assert [_number(text, 80) for text in texts] == [80] * 6 + [100, 99999]


@pytest.mark.parametrize(
    ("headers", "status"),
    [
        ({}, 200),
        ({"Cookie": ""}, 401),
        ({"Cookie": f"mavhelm-8000={TOKEN}"}, 401),
        ({"Cookie": "mavhelm-{port}=wrong"}, 401),
        ({"Cookie": "mavhelm-{port}="}, 401),
        ({"Cookie": '\xff;;=;"; mavhelm-{port}'}, 401),
        ({"Authorization": f"Bearer {TOKEN}", "Cookie": ""}, 401),
        ({"Host": "localhost:{port}"}, 200),
        ({"Host": "127.0.0.1"}, 403),
        ({"Host": "evil.example:{port}"}, 403),
        ({"Host": "[::1]:{port}"}, 403),
        ({"Origin": "http://127.0.0.1:{port}"}, 200),
        ({"Origin": "https://evil.example"}, 403),
        ({"Origin": "null"}, 403),
        ({"Host": "localhost:{port}", "Origin": "http://127.0.0.1:{port}"}, 403),
        ({"X-Forwarded-Host": "evil.example"}, 200),
    ],
)
async def test_who_is_let_in(headers: dict[str, str], status: int) -> None:
    async with served() as server:
        sent = {name: value.replace("{port}", str(server.port)) for name, value in headers.items()}
        for page in PAGES:
            found, text = await server.get(page, sent)
            assert found == status, page
            assert status == 200 or text in {
                "no valid token: open the address that `mavhelm serve --web` has printed\n",
                f"wrong Host: open http://127.0.0.1:{server.port}\n",
                "wrong Origin: only this server's own page may open it\n",
            }


@pytest.mark.parametrize(
    ("path", "status"),
    [
        (f"/?token={TOKEN}", 200),
        (f"/?token={TOKEN}&token=wrong", 200),
        ("/?token=wrong", 401),
        ("/?token=", 401),
        (f"/?Token={TOKEN}", 401),
        (f"//?token={TOKEN}", 401),
        (f"/page.js?token={TOKEN}", 401),
        (f"/ws?token={TOKEN}", 403),
        ("/nothing", 401),
        ("/static", 401),
    ],
)
async def test_the_token_lets_in_at_the_first_address_only(path: str, status: int) -> None:
    async with served() as server:
        assert (await server.get(path, {"Cookie": ""}))[0] == status


async def test_first_address_gives_a_cookie_and_leaves_the_token() -> None:
    async with served() as server:
        url = f"{server.base}/?token={TOKEN}"
        async with server.browser.get(url, headers={"Host": f"127.0.0.1:{server.port}"}) as answer:
            text, cookie = await answer.text(), answer.headers["Set-Cookie"]
            assert answer.content_type == "text/html"
        assert set(cookie.split("; ")) == {
            f"mavhelm-{server.port}={TOKEN}", "HttpOnly", "Path=/", "SameSite=Strict",
        }  # fmt: skip
        assert 'content="0; url=/"' in text
        assert TOKEN not in text


@pytest.mark.parametrize(
    ("path", "status", "kind"),
    [
        ("/", 200, "text/html"),
        ("/page.js", 200, "text/javascript"),
        ("/keys.js", 200, "text/javascript"),
        ("/stick.js", 200, "text/javascript"),
        ("/screen_socket.js", 200, "text/javascript"),
        ("/page.css", 200, "text/css"),
        ("/page.html", 404, "text/plain"),
        ("/page/page.js", 404, "text/plain"),
        ("/static/images/background.png", 200, "image/png"),
        ("/static/css/xterm.css", 200, "text/css"),
        ("/static", 403, "text/plain"),
        ("/static/", 403, "text/plain"),
        ("/static/js", 403, "text/plain"),
        ("/static/%2e%2e/server.py", 404, "text/plain"),
        ("/static/..%2fserver.py", 404, "text/plain"),
        ("/static//etc/passwd", 404, "text/plain"),
        ("/server.py", 404, "text/plain"),
        ("/favicon.ico", 404, "text/plain"),
    ],
)
async def test_the_browser_gets_its_own_files_and_no_other(path: str, status: int, kind: str) -> None:
    async with served() as server:
        reader = await server.connect(server.request(path, Connection="close"))
        head, _, body = (await rest_of(reader)).partition(b"\r\n\r\n")
        assert head.startswith(f"HTTP/1.1 {status} ".encode())
        assert f"Content-Type: {kind}".encode() in head
        assert b"Content-Security-Policy: default-src 'none'" in head
        assert b"X-Content-Type-Options: nosniff" in head
        assert b"Cache-Control: no-store" in head
        assert TOKEN.encode() not in head + body


@pytest.mark.parametrize(
    ("query", "size"),
    [("", 16), ("?fontsize=20", 20), ("?fontsize=0", 8), ("?fontsize=99", 40), ('?fontsize="><script>', 16)],
)
async def test_the_page_has_the_address_and_size_of_letters(query: str, size: int) -> None:
    async with served() as server:
        _, text = await server.get(f"/{query}")
        assert f'ws://127.0.0.1:{server.port}/ws" data-font-size="{size}"' in text
        assert "@" not in re.sub(r"@font-face", "", text)


async def test_the_script_is_that_of_the_page() -> None:
    async with served() as server:
        assert "focusTerminal" in (await server.get("/page.js"))[1]


@pytest.mark.parametrize(
    ("request_line", "status"),
    [
        ("rubbish", 400),
        ("\x16\x03\x01", 400),
        ("GET / HTTP/9", 400),
        ("GET /" + "a" * 10_000 + " HTTP/1.1", 400),
        ("GET / HTTP/1.1\r\nCookie: " + "a" * 10_000, 400),
        ("GET / HTTP/1.1\r\nHost: evil.example", 400),
        ("GET / HTTP/1.1\r\nno colon", 400),
        ("GET / HTTP/1.1\r\nContent-Length: 3\r\nTransfer-Encoding: chunked", 400),
        ("POST / HTTP/1.1\r\nContent-Length: 0", 405),
        ("GET http://evil.example/?token=x HTTP/1.1", 200),
    ],
)
async def test_a_malformed_request_ends_its_connection_only(request_line: str, status: int) -> None:
    async with served() as server:
        own = "".join(f"{name}: {value}\r\n" for name, value in server.own.items())
        reader = await server.connect(f"{request_line}\r\n{own}Connection: close\r\n\r\n")
        assert (await rest_of(reader)).startswith(f"HTTP/1.1 {status} ".encode()) or status == 400
        assert (await server.get("/"))[0] == 200


@pytest.mark.parametrize(
    ("headers", "status"),
    [
        ({"Origin": "http://127.0.0.1:{port}"}, 101),
        ({}, 403),
        ({"Origin": "https://evil.example"}, 403),
        ({"Origin": "null"}, 403),
        ({"Origin": "http://127.0.0.1:{port}", "Cookie": ""}, 401),
        ({"Origin": "http://127.0.0.1:{port}", "Host": "evil.example:{port}"}, 403),
        ({"Origin": "http://127.0.0.1:{port}", "Sec-WebSocket-Version": "12"}, 400),
        ({"Origin": "http://127.0.0.1:{port}", "Sec-WebSocket-Key": "short"}, 400),
        ({"Origin": "http://127.0.0.1:{port}", "Upgrade": "other"}, 400),
    ],
)
async def test_who_may_open_a_tab(headers: dict[str, str], status: int) -> None:
    async with served() as server:
        sent = {"Upgrade": "websocket", "Connection": "Upgrade", "Sec-WebSocket-Version": "13"}
        sent |= {"Sec-WebSocket-Key": "AAAAAAAAAAAAAAAAAAAAAA=="}
        sent |= {name: value.replace("{port}", str(server.port)) for name, value in headers.items()}
        for _ in range(8 if status != 101 else 1):  # who is refused takes no place
            reader = await server.connect(server.request("/ws", **sent))
            assert (await reader.readline()).startswith(f"HTTP/1.1 {status} ".encode())
        tab = await server.tab()
        await read_until(tab, "ready")


@pytest.mark.parametrize(
    ("query", "size"),
    [
        ("", "24 80"), ("?width=100&height=30", "30 100"), ("?width=1&height=1", "5 20"), ("?width=x&height=", "24 80"),
        ("?width=99999&height=99999", "200 500"),
    ],
)  # fmt: skip
async def test_a_tab_has_its_size_and_passes_both_ways(query: str, size: str) -> None:
    async with served() as server:
        tab = await server.tab(query)
        await tab.send_json(["stdin", "häh\r"])
        drawn = await read_until(tab, size)
        assert "got häh" in drawn
        await tab.send_json(["resize", {"width": 90, "height": 25}])
        await tab.send_json(["stdin", "\r"])
        await read_until(tab, "25 90")


async def test_the_end_of_the_screen_ends_the_tab(caplog: pytest.LogCaptureFixture) -> None:
    async with served("sh", "-c", "echo bye") as server:
        tab = await server.tab()
        await read_until(tab, "bye")
        assert await end_of(tab) == 1000
    assert caplog.records == []


@pytest.mark.parametrize("how", ["close", "abort"])
async def test_the_end_of_a_tab_ends_its_screen(how: str) -> None:
    async with served("sh", "-c", "echo pid=$$.; exec cat") as server:
        tab = await server.tab()
        pid = int((await read_until(tab, ".")).partition("pid=")[2].partition(".")[0])
        assert running(pid)
        if how == "close":
            await tab.close()
        else:
            connection = tab._response.connection
            assert connection is not None
            assert connection.transport is not None
            connection.transport.abort()
        await until(lambda: not running(pid))


async def next_tab(server: Served) -> aiohttp.ClientWebSocketResponse:
    """Open a tab as soon as there is a place."""
    async with asyncio.timeout(PATIENCE):
        while True:
            try:
                return await server.tab()
            except aiohttp.WSServerHandshakeError:
                await asyncio.sleep(0)


async def test_seven_tabs_at_once_and_another_after_one_ends() -> None:
    async with served() as server:
        tabs = [await server.tab() for _ in range(7)]
        with pytest.raises(aiohttp.WSServerHandshakeError) as refused:
            await server.tab()
        assert refused.value.status == 503
        assert (await server.get("/ws", {"Origin": server.base})) == (503, "7 tabs are open already\n")
        for number, each in enumerate(tabs):
            await each.send_json(["stdin", f"tab {number}\r"])
            await read_until(each, f"got tab {number}")
        for each in tabs[:2]:
            await each.send_json(["stdin", "\x04"])
            assert await end_of(each) == 1000
        tabs[:2] = [await next_tab(server), await next_tab(server)]
        with pytest.raises(aiohttp.WSServerHandshakeError):
            await server.tab()


async def test_a_pasted_text_arrives_whole() -> None:
    async with served(*PASTE) as server:
        tab = await server.tab()
        await read_until(tab, "ready")
        await tab.send_json(["stdin", "x" * 59_000 + "y" * 1000])
        await read_until(tab, "1000")


@pytest.mark.parametrize(("size", "code"), [(65_500, None), (65_537, 1009)])
async def test_a_message_has_65536_bytes_at_most(size: int, code: int | None) -> None:
    async with served() as server:
        tab = await server.tab()
        await read_until(tab, "ready")
        await tab.send_json(["ping", "x" * size])
        if code is not None:
            assert await end_of(tab) == code
            tab = await server.tab()
        await tab.send_json(["stdin", "here\r"])
        await read_until(tab, "got here")


MALFORMED = [
    ("", ""), ("{}", ""), ("[]", ""), ("null", ""), ("1", ""), ('"stdin"', ""), ('["other"]', ": $[0]"),
    ('["stdin"]', ""), ('["stdin", null]', ": $[1]"), ('["stdin", 1]', ": $[1]"), ('["stdin", "i", "k"]', ""),
    ('{"stdin": "i"}', ""), ("[" * 60_000, ""), ('["focus", 1]', ""), ('["stdin", "\\ud800"]', ""),
    ('["resize"]', ""), ('["resize", 3]', ": $[1]"), ('["resize", {"width": 30}]', ": $[1]"),
    ('["resize", {"width": "wide", "height": 3}]', ": $[1].width"),
    ('["resize", {"width": Infinity, "height": 3}]', ""),
    ('["pad", {}]', ": $[1]"),
    ('["pad", {"at": 1, "held": true, "x": 0, "y": 1.01, "buttons": []}]', ": $[1].y"),
    ('["pad", {"at": 1, "held": true, "x": 0, "y": NaN, "buttons": []}]', ""),
    ('["pad", {"at": -1, "held": true, "x": 0, "y": 1, "buttons": []}]', ": $[1].at"),
    ('["pad", {"at": 1, "held": 1, "x": 0, "y": 1, "buttons": []}]', ": $[1].held"),
    ('["pad", {"at": 1, "held": true, "x": 0, "y": 1, "buttons": ["rightshoulder"]}]', ": $[1].buttons"),
    ('["pad", {"at": 1, "held": true, "x": 0, "y": 1, "buttons": [], "arm": true}]', ": $[1]"),
]  # fmt: skip


@pytest.mark.parametrize(("text", "where"), MALFORMED)
async def test_a_malformed_message_ends_its_tab_with_a_reason(
    text: str, where: str, caplog: pytest.LogCaptureFixture
) -> None:
    async with served("sh", "-c", "echo pid=$$.; exec cat") as server:
        other, tab = await server.tab(), await server.tab()
        pid = int((await read_until(tab, ".")).partition("pid=")[2].partition(".")[0])
        await tab.send_str(text)
        async with asyncio.timeout(PATIENCE):
            while (ended := await tab.receive()).type is not aiohttp.WSMsgType.CLOSE:
                pass
        reason = f"malformed message from this tab{where}"
        assert ended.data == 1008
        assert ended.extra is not None
        assert ended.extra == reason or ended.extra.startswith(f"{reason}["), "an index, where there is one"
        assert caplog.messages == [f"a tab is closed: {ended.extra}"]
        await until(lambda: not running(pid))
        await other.send_json(["stdin", "still here\r"])
        await read_until(other, "still here")


async def test_a_message_of_bytes_ends_its_tab() -> None:
    async with served() as server:
        tab = await server.tab()
        await read_until(tab, "ready")
        await tab.send_bytes(b'["stdin", "no keys\\r"]')
        assert await end_of(tab) == 1008


async def test_a_tab_that_floods_ends_and_others_go_on() -> None:
    async with served() as server:
        other, tab = await server.tab(), await server.tab()
        with suppress(ConnectionError):
            for _ in range(5000):
                await tab.send_str('["ping","1"]')
        assert await end_of(tab) == 1008
        await other.send_json(["stdin", "here\r"])
        await read_until(other, "got here")


async def test_a_page_with_a_stick_is_told_the_time() -> None:
    async with served() as server:
        tab = await server.tab()
        await read_until(tab, "ready")
        await tab.send_json(["pad", {"at": 0, "held": False, "x": 0, "y": 0, "buttons": []}])
        times: list[float] = []
        async with asyncio.timeout(PATIENCE):
            while len(times) < 2:
                if (message := await tab.receive()).type is aiohttp.WSMsgType.TEXT:
                    name, at = message.json()
                    assert name == "clock"
                    times.append(at)
        assert 0 <= times[0] < times[1] - 900


async def test_a_tab_that_answers_no_ping_ends() -> None:
    async with served("sh", "-c", "echo pid=$$.; exec cat", heartbeat=0.2) as server:
        tab = await server.tab(autoping=False)
        pid = int((await read_until(tab, ".")).partition("pid=")[2].partition(".")[0])
        async with asyncio.timeout(PATIENCE):
            while (await tab.receive()).type != aiohttp.WSMsgType.PING:
                pass
        await until(lambda: not running(pid))


async def test_a_tab_that_answers_pings_goes_on() -> None:
    async with served(heartbeat=0.05) as server:
        tab = await server.tab()
        for count in range(20):
            await tab.send_json(["stdin", f"{count}.\r"])
            await read_until(tab, f"got {count}.")


async def test_a_screen_that_cannot_start_takes_no_place(caplog: pytest.LogCaptureFixture) -> None:
    async with served("/no/such/program") as server:
        for _ in range(8):
            status, text = await server.get("/ws", {"Origin": server.base})
            assert (status, text) == (503, "no screen: [Errno 2] No such file or directory: '/no/such/program'\n")
    assert caplog.messages == ["no screen for a tab: [Errno 2] No such file or directory: '/no/such/program'"] * 8


async def test_the_end_of_the_program_that_wants_it_ends_all() -> None:
    async with served("sh", "-c", "echo pid=$$.; exec cat", heartbeat=PATIENCE) as server:
        tab = await server.tab()
        pid = int((await read_until(tab, ".")).partition("pid=")[2].partition(".")[0])
        assert not server.task.done()
        server.end_parent()
        assert await end_of(tab) == 1000
        async with asyncio.timeout(PATIENCE):
            await server.task
        assert not running(pid)
        with pytest.raises(ConnectionRefusedError):
            await server.connect()


@pytest.mark.parametrize("apart", [True, False])
async def test_a_screen_that_ignores_the_end_is_killed(apart: bool) -> None:
    async with served("sh", "-c", "trap '' HUP; echo pid=$$.; exec sleep 600", apart=apart) as server:
        tab = await server.tab()
        pid = int((await read_until(tab, ".")).partition("pid=")[2].partition(".")[0])
        reading = asyncio.ensure_future(tab.receive())  # it answers pings, so that no heartbeat ends the tab
        server.end_parent()
        async with asyncio.timeout(30.0):  # aiohttp alone gives it 60 s
            await server.task
        await until(lambda: not running(pid))
        reading.cancel()


async def test_a_tab_ends_also_when_the_browser_does_not_read() -> None:
    """What is drawn then waits in the terminal, and the screen notices."""
    async with served("sh", "-c", "echo pid=$$.; exec yes", heartbeat=0.2) as server:
        tab = await server.tab(autoping=False)
        pid = int((await read_until(tab, ".")).partition("pid=")[2].partition(".")[0])
        await until(lambda: not running(pid))


async def test_the_token_is_not_logged(caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.DEBUG)
    async with served() as server:
        for path in (f"/?token={TOKEN}", f"/nothing?token={TOKEN}"):
            await server.get(path)
            await server.get(path, {"Cookie": ""})
    assert TOKEN not in caplog.text


class Program:
    """`main` in a thread, with a pipe as its standard input."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, said: str, *arguments: str) -> None:
        theirs, self._ours = os.pipe()
        self._input = os.fdopen(theirs)
        monkeypatch.setattr(sys, "stdin", self._input)
        os.write(self._ours, said.encode())
        sock = socket.create_server(("127.0.0.1", 0))
        self.port = sock.getsockname()[1]
        self._fd = sock.detach()
        self.task = asyncio.create_task(asyncio.to_thread(main, [f"--fd={self._fd}", "--", *arguments]))

    def end_parent(self) -> None:
        os.close(self._ours)

    def close_port(self) -> None:
        """Close what a program that does not serve has left."""
        os.close(self._fd)

    async def ended(self) -> int:
        async with asyncio.timeout(PATIENCE):
            code = await self.task
        self._input.close()
        return code


@pytest.fixture
def loggers() -> Iterator[list[logging.Logger]]:
    found = [logging.getLogger(name) for name in ("aiohttp.server", "asyncio")]
    before = [list(each.filters) for each in found]
    yield found
    for each, filters in zip(found, before, strict=True):
        each.filters[:] = filters


async def test_the_program_serves_groundstation_in_tabs(
    monkeypatch: pytest.MonkeyPatch, loggers: list[logging.Logger], caplog: pytest.LogCaptureFixture
) -> None:
    program = Program(monkeypatch, f"{TOKEN}\n", "--version")
    base = f"http://127.0.0.1:{program.port}"
    headers = {"Cookie": f"mavhelm-{program.port}={TOKEN}", "Origin": base}
    async with (
        aiohttp.ClientSession(headers=headers) as browser,
        browser.ws_connect(f"{base}/ws") as tab,
    ):
        await read_until(tab, "mavhelm 0.")
        for each in loggers:
            for _ in range(30):
                each.warning("rubbish")
    assert caplog.messages.count("rubbish") == 40, "20 lines of each"
    program.end_parent()
    assert await program.ended() == 0


async def test_rubbish_of_a_stranger_is_one_line_in_the_log(
    monkeypatch: pytest.MonkeyPatch, loggers: list[logging.Logger], caplog: pytest.LogCaptureFixture
) -> None:
    program = Program(monkeypatch, f"{TOKEN}\n")
    reader, writer = await asyncio.open_connection("127.0.0.1", program.port)
    writer.write(b"GET / HTTP/1.1\r\n\x1b[31mrubbish\r\n\r\n")
    assert (await rest_of(reader)).startswith(b"HTTP/1.0 400 ")
    writer.close()
    program.end_parent()
    assert await program.ended() == 0
    [record] = [each for each in caplog.records if each.name == loggers[0].name]
    assert record.getMessage().startswith("Error handling request from 127.0.0.1: ")
    assert "rubbish" not in logging.Formatter().format(record)


async def test_without_a_token_the_program_does_not_serve(
    monkeypatch: pytest.MonkeyPatch, loggers: list[logging.Logger]
) -> None:
    """An empty cookie must not be the right one."""
    program = Program(monkeypatch, "\n")
    assert await program.ended() == 1
    program.end_parent()
    program.close_port()


@pytest.mark.parametrize(
    ("arguments", "code", "text"),
    [
        (["--help"], 0, r"usage: groundstation.web.server .*the socket that listens"),
        (["--help"], 0, r"\brest\b.*arguments of `mavhelm` for a tab"),
        ([], 2, "the following arguments are required: --fd"),
        (["--fd", "x"], 2, "argument --fd: invalid int value: 'x'"),
    ],
)
def test_arguments_of_the_program(
    arguments: list[str], code: int, text: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as ended:
        main(arguments)
    assert ended.value.code == code
    assert re.search(text, "".join(capsys.readouterr()), re.DOTALL)
