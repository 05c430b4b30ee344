"""The web server in the event loop of a test: its own sockets on loopback, real requests, and programs in its tabs."""

from __future__ import annotations

import asyncio
import os
import socket
from collections.abc import AsyncIterator, Mapping
from contextlib import asynccontextmanager, suppress
from types import MappingProxyType
from typing import Any

import aiohttp

from groundstation.web.door import REQUEST_WITHIN
from groundstation.web.guard import Guard
from groundstation.web.server import HEARTBEAT, WebServer, serve

TOKEN = "the-token-of-this-run"
PATIENCE = 10.0
"""s until a test gives up. Nothing is asserted by it."""
PATIENT = aiohttp.ClientTimeout(total=PATIENCE)
ECHO = ("sh", "-c", "echo ready; while read -r line; do echo got $line; stty size; done")
"""A program in a tab: repeats each line, and says the rows and columns of its terminal."""


class Served:
    """A server that runs, and a browser that is let in."""

    def __init__(self, port: int, browser: aiohttp.ClientSession, parent: int, task: asyncio.Task[None]) -> None:
        self.port, self.browser, self.task = port, browser, task
        self.base = f"http://127.0.0.1:{port}"
        self.own = {"Host": f"127.0.0.1:{port}", "Cookie": f"mavhelm-{port}={TOKEN}"}
        """Headers of a browser that has the token."""
        self.writers: list[asyncio.StreamWriter] = []
        self.tabs: list[aiohttp.ClientWebSocketResponse] = []
        """Bare connections and tabs, which are closed at the end."""
        self._parent = parent

    async def get(self, path: str, headers: Mapping[str, str] = MappingProxyType({})) -> tuple[int, str]:
        """Return the status and the text of an answer."""
        async with self.browser.get(self.base + path, headers={**self.own, **headers}, allow_redirects=False) as answer:
            return answer.status, await answer.text()

    async def tab(self, query: str = "", **options: Any) -> aiohttp.ClientWebSocketResponse:
        """Open a tab. Raises aiohttp.WSServerHandshakeError."""
        headers = {**self.own, "Origin": self.base}
        tab: aiohttp.ClientWebSocketResponse = await self.browser.ws_connect(
            f"{self.base}/ws{query}", headers=headers, **options
        )
        self.tabs.append(tab)
        return tab

    async def connect(self, data: str = "") -> asyncio.StreamReader:
        """Open a bare connection, say something over it, and return what reads the answers."""
        reader, writer = await asyncio.open_connection("127.0.0.1", self.port)
        self.writers.append(writer)
        writer.write(data.encode())
        return reader

    def request(self, path: str = "/", *, method: str = "GET", **headers: str) -> str:
        """Return the text of a request of a browser that has the token."""
        lines = "".join(f"{name}: {value}\r\n" for name, value in {**self.own, **headers}.items())
        return f"{method} {path} HTTP/1.1\r\n{lines}\r\n"

    def end_parent(self) -> None:
        """Do what the kernel does when the program that has started the server ends."""
        if self._parent >= 0:
            os.close(self._parent)
            self._parent = -1


@asynccontextmanager
async def served(
    *command: str, heartbeat: float = HEARTBEAT, within: float = REQUEST_WITHIN, apart: bool = False
) -> AsyncIterator[Served]:
    """Serve, with `command` in each tab, until the end of the block. Its own failures are raised.

    `apart`: in a loop of its own, as in its process.
    """
    sock = socket.create_server(("127.0.0.1", 0))
    port = sock.getsockname()[1]
    theirs, ours = os.pipe()
    server = WebServer(Guard(port, TOKEN), command or ECHO, heartbeat=heartbeat)
    serving = serve(sock, server, theirs, within=within)
    task = asyncio.create_task(asyncio.to_thread(asyncio.run, serving) if apart else serving)
    async with aiohttp.ClientSession(cookie_jar=aiohttp.DummyCookieJar(), timeout=PATIENT) as browser:
        found = Served(port, browser, ours, task)
        try:
            yield found
        finally:
            for writer in found.writers:
                writer.close()
            for tab in found.tabs:
                await tab.close()
            found.end_parent()
            async with asyncio.timeout(PATIENCE):
                await task
            assert not asyncio.get_running_loop().remove_reader(theirs)
            os.close(theirs)


async def read_until(tab: aiohttp.ClientWebSocketResponse, end: str) -> str:
    """Return what a tab draws, up to a text. Raises AssertionError if the tab ends before."""
    drawn = ""
    async with asyncio.timeout(PATIENCE):
        while end not in drawn:
            message = await tab.receive()
            assert message.type == aiohttp.WSMsgType.BINARY, (message, drawn)
            drawn += message.data.decode()
    return drawn


async def end_of(tab: aiohttp.ClientWebSocketResponse) -> int | None:
    """Wait until the server ends a tab; return the code, None without one."""
    async with asyncio.timeout(PATIENCE):
        while (await tab.receive()).type not in (aiohttp.WSMsgType.CLOSE, aiohttp.WSMsgType.CLOSED):
            pass
    return tab.close_code


async def rest_of(reader: asyncio.StreamReader) -> bytes:
    """Return what comes over a bare connection until the server ends it."""
    data = b""
    with suppress(ConnectionResetError):
        async with asyncio.timeout(PATIENCE):
            while part := await reader.read(1 << 16):
                data += part
    return data


async def answer_on(reader: asyncio.StreamReader) -> int:
    """Return the status of one answer of a bare connection that stays open."""
    async with asyncio.timeout(PATIENCE):
        head = (await reader.readuntil(b"\r\n\r\n")).decode()
        length = next(int(line.split(":")[1]) for line in head.splitlines() if line.startswith("Content-Length"))
        await reader.readexactly(length)
    return int(head.split()[1])
