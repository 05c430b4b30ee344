"""The process of the web server: pages and sockets behind the guard. Started by launch.py, not by hand.

The front end (xterm.js in textual.js, its style and fonts) is that of textual-serve; nothing else is loaded.
"""

from __future__ import annotations

import argparse
import asyncio
import contextlib
import logging
import os
import socket
import sys
import time
from collections.abc import Awaitable, Callable, Sequence
from importlib.resources import files
from pathlib import Path
from typing import Any

from aiohttp import WSCloseCode, WSMsgType, web
from aiohttp.http import HttpProcessingError

from groundstation.input.touch_stick import TouchStick
from groundstation.web.door import REQUEST_WITHIN, Door, FewLines
from groundstation.web.guard import HEADERS, TOKEN, Guard, WebRequest
from groundstation.web.messages import Resized, TabMessage, TabMessageError, TabMessages, Touched, Typed
from groundstation.web.tab import Tab, screen_command

MAX_TABS = 7
"""Tabs at once: a station takes 8 screens, and one is left for a terminal."""

MAX_MESSAGE = 1 << 16
"""Bytes of a message from a tab: a pasted text."""

HEARTBEAT = 4.0
"""s between pings of a socket. A lost tab ends within 6 s; its screen was neutral 0.5 s after the loss."""

CLOCK_PERIOD = 1.0
"""s between two times that a page with a thumb stick is told, by which its demands have an age."""

SHUTDOWN = 1.0
"""s for the screens to end when the server ends, before they are killed."""

FILES = {
    "page.js": "text/javascript",
    "page.css": "text/css",
    "screen_socket.js": "text/javascript",
    "keys.js": "text/javascript",
    "stick.js": "text/javascript",
}
"""What our page loads beside the front end -> its type."""

DEFAULT_SIZE, DEFAULT_FONT = (80, 24), 16
"""Columns and rows, and pixels of the letters, where the address does not say."""

log = logging.getLogger("groundstation.web")

ENTER = (
    '<!DOCTYPE html><meta charset="utf-8"><meta http-equiv="refresh" content="0; url=/"><title>mavhelm</title>'
    '<link rel="icon" href="data:,">'
)
"""Answers the first address. The next one is without the token, and asked for by our own page, as the cookie wants.
Without the link a browser asks for /favicon.ico if it shows this page long enough."""

Handler = Callable[[web.Request], Awaitable[web.StreamResponse]]


class WebServer:
    """One port, one station. `command` runs the screen of a tab in its terminal."""

    def __init__(self, guard: Guard, command: Sequence[str], *, heartbeat: float = HEARTBEAT) -> None:
        self._guard, self._command, self._heartbeat = guard, command, heartbeat
        self._tabs: set[Tab] = set()
        self.door: Door | None = None
        """Bounds who has connected and asks nothing; None: nobody waits there."""
        folder = Path(__file__).parent / "page"
        self._page, *texts = ((folder / name).read_text(encoding="utf-8") for name in ("page.html", *FILES))
        self._files = dict(zip(FILES, texts, strict=True))

    def build(self) -> web.Application:
        """Return the application."""

        @web.middleware
        async def check(request: web.Request, handler: Handler) -> web.StreamResponse:
            refused = self._refuse(request)
            if refused is not None:  # not its truth: in aiohttp 3.9 a response is an empty mapping
                return refused
            if self.door is not None:
                self.door.admit(request.transport)
            return await handler(request)

        app = web.Application(middlewares=[check])
        app.add_routes(
            [
                web.get("/", self._show_page),
                *(web.get(f"/{name}", self._show_file) for name in FILES),
                web.get(self._guard.socket_path, self._run_tab),
                web.static("/static", str(files("textual_serve") / "static")),
            ]
        )
        app.on_response_prepare.append(_add_headers)
        app.on_shutdown.append(self._hang_up)
        return app

    def _refuse(self, request: web.Request) -> web.Response | None:
        asked = WebRequest(
            path=request.path,
            hosts=request.headers.getall("Host", []),
            origins=request.headers.getall("Origin", []),
            token=request.query.get(TOKEN),
            cookie=request.cookies.get(self._guard.cookie_name),
        )
        refusal = self._guard.refuse(asked)
        if refusal is None:
            return None
        response = web.Response(status=refusal.status, text=f"{refusal.line}\n")
        response.force_close()  # who is refused keeps no connection
        return response

    async def _show_page(self, request: web.Request) -> web.StreamResponse:
        if TOKEN in request.query:
            response = web.Response(text=ENTER, content_type="text/html")
            name = self._guard.cookie_name
            response.set_cookie(name, self._guard.token, httponly=True, samesite="Strict")
            return response
        size = min(40, max(8, _number(request.query.get("fontsize"), DEFAULT_FONT)))
        page = self._page.replace("@HOST@", request.host).replace("@SIZE@", str(size))
        return web.Response(text=page, content_type="text/html")

    async def _show_file(self, request: web.Request) -> web.StreamResponse:
        name = request.path.removeprefix("/")
        return web.Response(text=self._files[name], content_type=FILES[name])

    async def _run_tab(self, request: web.Request) -> web.StreamResponse:
        """Run one screen as long as its socket is open, or until it ends."""
        if len(self._tabs) >= MAX_TABS:
            return web.Response(status=503, text=f"{MAX_TABS} tabs are open already\n")
        columns, rows = DEFAULT_SIZE
        size = (_number(request.query.get("width"), columns), _number(request.query.get("height"), rows))
        try:
            tab = Tab.open(self._command, size)
        except OSError as error:
            log.error("no screen for a tab: %s", error)
            return web.Response(status=503, text=f"no screen: {error}\n")
        sock = web.WebSocketResponse(heartbeat=self._heartbeat, max_msg_size=MAX_MESSAGE)
        self._tabs.add(tab)
        try:
            await sock.prepare(request)
            await _join(tab, sock)
        finally:
            await asyncio.shield(tab.close())
            self._tabs.remove(tab)
        return sock

    async def _hang_up(self, app: web.Application) -> None:
        """End the screens, so that each shows its end and closes its socket."""
        for tab in self._tabs:
            tab.hang_up()

    def kill_screens(self) -> None:
        """End those that are still there when the server has ended."""
        for tab in self._tabs:
            tab.kill()


async def _join(tab: Tab, sock: web.WebSocketResponse) -> None:
    """Pass both ways until one of them ends. A tab that sends what it must not is closed, which means neutral."""

    async def show() -> None:
        with contextlib.suppress(ConnectionError):
            await tab.show(sock.send_bytes)
        await sock.close()

    messages, stick = TabMessages(), TouchStick(time.monotonic())
    tasks = [asyncio.create_task(show())]
    try:
        async for message in sock:
            found = messages.read(message.data if message.type == WSMsgType.TEXT else "", time.monotonic())
            if isinstance(found, Touched) and len(tasks) == 1:
                tasks.append(asyncio.create_task(_tell_time(stick, sock)))
            _take(tab, stick, found)
    except TabMessageError as error:
        log.warning("a tab is closed: %s", error)
        tab.hang_up()  # neutral before the browser answers
        await sock.close(code=WSCloseCode.POLICY_VIOLATION, message=str(error).encode())
    finally:
        for task in tasks:
            task.cancel()
            with contextlib.suppress(asyncio.CancelledError):
                await task


def _take(tab: Tab, stick: TouchStick, message: TabMessage) -> None:
    """Carry out a message."""
    match message:
        case Typed(text):
            tab.type(text)
        case Resized(size):
            tab.resize((size.width, size.height))
        case Touched(reading) if (frame := stick.take(reading, time.monotonic())) is not None:
            tab.touch(frame)


async def _tell_time(stick: TouchStick, sock: web.WebSocketResponse) -> None:
    """Tell a page the time again and again, until its socket ends."""
    with contextlib.suppress(ConnectionError):
        while not sock.closed:
            await sock.send_json(["clock", stick.clock(time.monotonic())])
            await asyncio.sleep(CLOCK_PERIOD)


def _number(text: str | None, default: int) -> int:
    return int(text) if text is not None and text.isascii() and text.isdecimal() and len(text) < 6 else default


async def _add_headers(request: web.Request, response: web.StreamResponse) -> None:
    response.headers.update(HEADERS)


async def serve(sock: socket.socket, server: WebServer, parent: int, *, within: float = REQUEST_WITHIN) -> None:
    """Serve until the file descriptor `parent` is closed at its other end: the program that wants it has ended.

    A request, and the next one of a connection, must arrive `within` s.
    """
    runner = web.AppRunner(
        server.build(),
        access_log=None,
        shutdown_timeout=SHUTDOWN,
        keepalive_timeout=within,
        lingering_time=0.0,  # no request here has a body
    )
    await runner.setup()
    assert runner.server is not None
    server.door = Door(runner.server, within=within)
    loop = asyncio.get_running_loop()
    listening = await loop.create_server(server.door, sock=sock)
    ended = asyncio.Event()
    loop.add_reader(parent, ended.set)
    try:
        await ended.wait()
    finally:
        loop.remove_reader(parent)
        listening.close()
        await runner.cleanup()
        server.kill_screens()


def main(arguments: Sequence[str] | None = None) -> int:
    """Serve the tabs of one station; the token comes as the first line of standard input."""
    parser = argparse.ArgumentParser(prog="groundstation.web.server")
    parser.add_argument("--fd", type=int, required=True, help="the socket that listens")
    parser.add_argument("rest", nargs="*", help="arguments of `mavhelm` for a tab")
    options: Any = parser.parse_args(arguments)
    parent = sys.stdin.fileno()
    token = os.read(parent, 256).decode().strip()
    if not token:  # it has ended before it said one; an empty cookie must not be right
        return 1
    sock = socket.socket(fileno=options.fd)
    for name in ("aiohttp.server", "asyncio", log.name):
        logging.getLogger(name).addFilter(FewLines(brief=(HttpProcessingError,)))
    guard = Guard(sock.getsockname()[1], token)
    asyncio.run(serve(sock, WebServer(guard, screen_command(options.rest)), parent))
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
