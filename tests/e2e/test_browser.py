"""Screens in a browser, with the real server, station and rover: who is let in, and what a lost tab means.

Each stop first sees the wheels turn.
"""

from __future__ import annotations

import asyncio
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Awaitable, Callable, Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import NamedTuple

import aiohttp
import pytest

from groundstation.station_socket.connect import running_stations
from groundstation.web.launch import missing_package
from tests.e2e.chromium import PROGRAM, Browser, eventually, pause
from tests.e2e.programs import Vehicle
from tests.e2e.relay import Relay
from tests.groundstation.held_key import DELAY, GAP
from tests.groundstation.screen import children, running
from tests.ports import free_port
from tests.waits import PATIENCE, Patience, Waits

pytestmark = [
    pytest.mark.e2e,
    pytest.mark.xdist_group("browser"),  # several at once starve each other
    pytest.mark.skipif(missing_package() is not None, reason="the extra [web] is not installed"),
]
needs_chromium = pytest.mark.skipif(
    PROGRAM is None and not os.environ.get("MAVHELM_CI"), reason="chromium is not installed"
)

ROOT = Path(__file__).parents[2]
LONGER_THAN_TIMERS = 1.6
"""s: without reported releases a press would end after 1.1 s at most."""
RAMP, SLACK, TRY = 0.4, 0.25, 4.0
"""s of our rover from full to neutral, of the programs between, and for one try to arm or drive."""


class Rig:
    """`mavhelm serve --web` for a simulated rover."""

    def __init__(self, folder: Path, stack: ExitStack) -> None:
        self.between: list[int] = []
        """Process ids of browsers, whose delays also count: a key passes through three processes there."""
        self.relay = Relay()
        stack.callback(self.relay.close)
        self.port = free_port()
        options = ["--port", str(self.port), "--no-record", f"udpin:127.0.0.1:{self.relay.ground_port}"]
        command = [sys.executable, "-m", "groundstation", "serve", "--web", *options]
        self.process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True, cwd=ROOT)
        stack.callback(self.end)
        assert self.process.stderr is not None
        self.process.stderr.readline()
        said = self.process.stderr.readline()
        [self.url] = re.findall(r"in a browser on this machine: (http://\S+\?token=\S{40,})", said)
        self.base = self.url.partition("/?")[0]
        assert self.process.pid in running_stations(), "a tab that is opened at once finds the station"
        self.vehicle = Vehicle(folder, self.relay.vehicle_port)
        stack.callback(self.vehicle.end)

    @property
    def server(self) -> int:
        """Process id of the web server."""
        processes = children(self.process.pid)
        return next(each for each in processes if b"web.server" in Path(f"/proc/{each}/cmdline").read_bytes())

    def end(self) -> None:
        assert self.process.stderr is not None
        self.process.kill()
        self.process.wait()
        self.process.stderr.close()

    async def stops(self, act: Callable[[], object], within: float = 0.0) -> None:
        """Act while the wheels turn, and see the demand end `within` s, and the wheels stop.

        `act` may return what is waited for.
        """
        assert self.vehicle.turning()
        waits = Waits(self.process.pid, self.server, self.vehicle.process.pid, *self.between)
        at = time.monotonic()
        doing = act()
        if isinstance(doing, Awaitable):
            await doing
        await eventually(self.vehicle.stands)
        fell, stopped = self.vehicle.falls_and_stops_after(at)
        assert fell < within + SLACK + waits.total()
        assert stopped < within + RAMP + SLACK + waits.total()
        assert running(self.process.pid), "the station goes on"


@pytest.fixture
def rig(tmp_path: Path) -> Iterator[Rig]:
    with ExitStack() as stack:
        yield Rig(tmp_path, stack)


class SocketTab:
    """A tab without a browser: what textual.js sends, and answers to pings of the screen."""

    def __init__(self, socket: aiohttp.ClientWebSocketResponse) -> None:
        self.socket = socket
        self.drawn = b""
        self.ended = False
        self._task = asyncio.create_task(self._read())

    async def type(self, keys: str) -> None:
        await self.socket.send_json(["stdin", keys])

    async def hold(self, key: str, until: Callable[[], bool]) -> bool:
        await self.type(key)
        await pause(DELAY)
        end = time.monotonic() + TRY
        while not until() and time.monotonic() < end:
            await self.type(key)
            await pause(GAP)
        return until()

    async def _read(self) -> None:
        async for message in self.socket:
            self.drawn += message.data
            for _ in range(message.data.count(b"\x1b[5n")):
                await self.type("\x1b[0n")
        self.ended = True


async def drive(rig: Rig, tab: SocketTab | Browser) -> None:
    """Arm and drive until the wheels turn; the key stays down.

    Again, if a late machine has ended it, and with control taken again: the tab may have drawn nothing the first time.
    """

    async def hold(key: str, until: Callable[[], bool]) -> bool:
        return await (tab.hold(key, until) if isinstance(tab, SocketTab) else tab.hold(key, until, TRY))

    patience = Patience(PATIENCE, rig.process.pid, rig.vehicle.process.pid)
    while not (rig.relay.armed() or await hold("r", rig.relay.armed)) or not await hold("i", rig.vehicle.at_full):
        assert not patience.ended, rig.vehicle.errors.read_text()
        if isinstance(tab, Browser):
            await tab.release("r")
            await tab.release("i")
        await pause(1.2)
        if isinstance(tab, Browser):
            await tab.press("g")
            await tab.release("g")
        else:
            await tab.type("g")


async def test_who_is_let_in_and_what_a_lost_socket_means(rig: Rig) -> None:
    own = {"Origin": rig.base}
    async with aiohttp.ClientSession(cookie_jar=aiohttp.CookieJar(unsafe=True)) as stranger:
        for path, headers, status in [
            ("/", {}, 401),
            ("/?token=wrong", {}, 401),
            ("/static/js/textual.js", {}, 401),
            ("/", {"Host": f"evil.example:{rig.port}"}, 403),
            (rig.url.removeprefix(rig.base), {"Host": f"evil.example:{rig.port}"}, 403),
        ]:
            async with stranger.get(rig.base + path, headers=headers) as answer:
                assert answer.status == status, path
        with pytest.raises(aiohttp.WSServerHandshakeError, match="401"):
            await stranger.ws_connect(f"{rig.base}/ws", headers=own)
    async with aiohttp.ClientSession(cookie_jar=aiohttp.CookieJar(unsafe=True)) as browser:
        async with browser.get(rig.url) as answer:
            assert answer.status == 200
            text = await answer.text()
            assert "token" not in text
            assert 'rel="icon"' in text, "browsers ask for /favicon.ico, which is not there"
            cookie = answer.headers["Set-Cookie"]
            assert "HttpOnly" in cookie
            assert "SameSite=Strict" in cookie
        for headers in ({"Origin": "https://evil.example"}, {}, {**own, "Host": "evil.example"}):
            with pytest.raises(aiohttp.WSServerHandshakeError, match="403"):
                await browser.ws_connect(f"{rig.base}/ws", headers=headers)

        tab = SocketTab(await browser.ws_connect(f"{rig.base}/ws?width=100&height=30", headers=own))
        await eventually(lambda: b"you watch: no screen drives" in tab.drawn and b"disarmed" not in tab.drawn)
        await tab.hold("r", rig.relay.armed)
        assert not rig.relay.armed(), "a tab only watches until it is told to drive"
        await tab.type("g")
        await eventually(lambda: b"disarmed: hold" in tab.drawn)
        await drive(rig, tab)
        connection = tab.socket._response.connection
        assert connection is not None
        assert connection.transport is not None
        await rig.stops(connection.transport.abort)
        await tab.socket.close()

        tab = SocketTab(await browser.ws_connect(f"{rig.base}/ws?width=100&height=30", headers=own))
        await eventually(lambda: b" ARMED " in tab.drawn)
        await tab.type("g")
        await pause(1.0)
        await tab.type("1")  # the rover has changed to HOLD if the tab took long
        await drive(rig, tab)
        await rig.stops(lambda: os.kill(rig.server, signal.SIGKILL))
        await tab.socket.close()


@needs_chromium
async def test_a_browser_tab_drives_offline_and_stops_when_it_dies(rig: Rig, tmp_path: Path) -> None:
    async with Browser(tmp_path) as browser:
        rig.between.append(browser.process.pid)
        await browser.open(rig.url)
        assert not await browser.evaluate("matchMedia('(pointer: coarse)').matches")
        assert await browser.evaluate("document.getElementById('touch').hidden"), "no stick without a touch screen"
        assert await browser.evaluate("location.href") == f"{rig.base}/", "the token is not in the address"
        await pause(1.0)
        await browser.press("g")
        await browser.release("g")
        await drive(rig, browser)
        allowed = (f"{rig.base}/", f"ws://127.0.0.1:{rig.port}/ws", "data:", "blob:")
        assert [url for url in browser.requests if not url.startswith(allowed)] == []
        assert any(url.endswith("RobotoMono-VariableFont_wght.ttf") for url in browser.requests)
        assert browser.problems == []
        await rig.stops(browser.kill)


PINGS = 0.85
"""s until a screen knows that its terminal is silent: two pings of 0.25 s after one that was answered, and a tick."""


async def drive_exactly(rig: Rig, browser: Browser) -> None:
    """Arm, then press the drive key once, and see the wheels turn for longer than any timer without a repeat."""
    await drive(rig, browser)
    await browser.release("i")
    await eventually(rig.vehicle.stands)
    patience = Patience(PATIENCE, rig.process.pid, rig.vehicle.process.pid)
    while True:
        await browser.press("i")
        await pause(LONGER_THAN_TIMERS)
        if rig.vehicle.at_full():
            return
        assert not patience.ended, rig.vehicle.errors.read_text()
        await browser.release("i")
        await pause(1.2)


async def freeze_by_signal(browser: Browser) -> None:
    browser.signal_pages(signal.SIGSTOP)


async def go_on(browser: Browser) -> None:
    browser.signal_pages(signal.SIGCONT)


class Stop(NamedTuple):
    """What ends a key that is held in a tab."""

    act: Callable[[Browser], Awaitable[None]]
    within: float = 0.0
    """s until the demand ends."""
    undo: Callable[[Browser], Awaitable[None]] | None = None
    """What lets the tab go on; a key of before drives no more."""


KEY_STOPS = {
    "released": Stop(lambda browser: browser.release("i")),
    "frozen": Stop(freeze_by_signal, PINGS, go_on),
    "focus lost": Stop(Browser.lose_focus),
    "hidden": Stop(Browser.hide, undo=Browser.show),
    "asleep": Stop(Browser.freeze),
}


@needs_chromium
@pytest.mark.timeout(1200)
async def test_a_key_of_a_tab_drives_exactly_until_it_ends(rig: Rig, tmp_path: Path) -> None:
    """One after the other with the same programs and browser, because their start takes most of the CPU."""
    async with Browser(tmp_path) as browser:
        rig.between.append(browser.process.pid)
        await browser.open(rig.url)
        await pause(1.0)
        await browser.press("g")
        await browser.release("g")
        for name, stop in KEY_STOPS.items():
            await drive_exactly(rig, browser)
            assert browser.problems == [], name
            await rig.stops(lambda act=stop.act: act(browser), stop.within)  # type: ignore[misc]
            if stop.undo is not None:
                at = time.monotonic()
                await stop.undo(browser)
                await pause(1.5)
                assert not rig.vehicle.moved_since(at), f"{name}: a key of before drives no more"
