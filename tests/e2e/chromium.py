"""A headless Chromium with one page, operated over the Chrome DevTools protocol."""

from __future__ import annotations

import asyncio
import base64
import json
import os
import shutil
import signal
import subprocess
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

import aiohttp

from tests.groundstation.screen import children
from tests.waits import PATIENCE

PROGRAM = shutil.which("chromium")
OPTIONS = (
    "--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-sync",
    "--disable-background-networking", "--disable-component-update", "--disable-dev-shm-usage",
    "--remote-debugging-port=0",
)  # fmt: skip
CODES = {"i": "KeyI", "u": "KeyU", "r": "KeyR", "g": "KeyG", "1": "Digit1"}
GAP = 0.033


class Browser:
    """One page. Use `async with`. A small one draws faster without a graphics card, so that keys repeat evenly."""

    def __init__(self, folder: Path, size: tuple[int, int] = (640, 420), *options: str) -> None:
        assert PROGRAM is not None
        self._folder = folder / "profile"
        window = f"--window-size={size[0]},{size[1]}"
        self.process = subprocess.Popen(
            [PROGRAM, *OPTIONS, *options, window, f"--user-data-dir={self._folder}", "about:blank"],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        self._session = aiohttp.ClientSession()
        self._number = 0
        self._answers: dict[int, asyncio.Future[dict[str, Any]]] = {}
        self.requests: list[str] = []
        """Addresses that the page has asked for."""
        self.on_frame: Callable[[str, str], None] = lambda received, sent: None
        """Called with the text of each frame of a WebSocket, in base64 if it is binary: received, or sent."""
        self.problems: list[str] = []
        """Requests that failed or were forbidden, and exceptions."""

    async def __aenter__(self) -> Browser:
        try:
            await self._connect()
        except BaseException:
            self.kill()
            await self._session.close()
            raise
        return self

    async def _connect(self) -> None:
        marker = self._folder / "DevToolsActivePort"
        await eventually(lambda: marker.exists() and marker.read_text(), self.process)
        port = marker.read_text().split()[0]
        async with self._session.get(f"http://127.0.0.1:{port}/json/list") as answer:
            [page] = [each for each in await answer.json() if each["type"] == "page"]
        self._socket = await self._session.ws_connect(page["webSocketDebuggerUrl"], max_msg_size=0)
        self._reading = asyncio.create_task(self._read())
        for domain in ("Page", "Network", "Runtime", "Log"):
            await self.call(f"{domain}.enable")
        await self.call("Emulation.setFocusEmulationEnabled", enabled=True)

    async def __aexit__(self, *_: object) -> None:
        self._reading.cancel()
        self.kill()
        await self._socket.close()
        await self._session.close()

    def kill(self) -> None:
        """Kill it with -9; its children follow, also those that are stopped."""
        children = _descendants(self.process.pid)
        self.process.kill()
        self.process.wait()
        for pid in children:
            with suppress(ProcessLookupError):
                os.kill(pid, signal.SIGKILL)

    async def call(self, method: str, **parameters: Any) -> dict[str, Any]:
        """Call a method of the protocol; return its result."""
        return await asyncio.wait_for(await self._send(method, parameters), PATIENCE)

    async def _send(self, method: str, parameters: dict[str, Any]) -> asyncio.Future[dict[str, Any]]:
        self._number += 1
        answer = self._answers[self._number] = asyncio.get_running_loop().create_future()
        await self._socket.send_json({"id": self._number, "method": method, "params": parameters})
        return answer

    async def evaluate(self, expression: str) -> Any:
        """Return the value of a JavaScript expression."""
        result = await self.call("Runtime.evaluate", expression=expression, returnByValue=True)
        return result.get("result", {}).get("value")  # none while the page is replaced

    async def open(self, url: str) -> None:
        """Open an address and wait until its terminal has drawn."""
        await self.call("Page.navigate", url=url)
        async with asyncio.timeout(PATIENCE):
            while not await self.evaluate("document.body && document.body.classList.contains('-first-byte')"):
                await pause(0.05)

    async def send_key(self, kind: str, **event: Any) -> None:
        """Send a "keyDown" or "keyUp" of any key."""
        await self._send("Input.dispatchKeyEvent", {"type": kind, **event})

    async def press(self, key: str, *, repeat: bool = False) -> None:
        """Press a key of a character, or let it repeat. A page that draws slowly answers late: nobody waits for it."""
        await self._send("Input.dispatchKeyEvent", {**_key("keyDown", key), "text": key, "autoRepeat": repeat})

    async def release(self, key: str) -> None:
        """Release it."""
        await self._send("Input.dispatchKeyEvent", _key("keyUp", key))

    async def hold(self, key: str, until: Callable[[], bool], within: float) -> bool:
        """Hold a key with auto-repeat until the condition; return whether it came true. The key stays down."""
        await self.press(key)
        end = asyncio.get_running_loop().time() + within
        while not until() and asyncio.get_running_loop().time() < end:
            await pause(GAP)
            await self.press(key, repeat=True)
        return until()

    async def become_a_phone(self, size: tuple[int, int] = (390, 844)) -> None:
        """Have a touch screen of this size in place of a mouse; before a page is opened."""
        width, height = size
        await self.call(
            "Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=0, mobile=True
        )
        await self.call("Emulation.setTouchEmulationEnabled", enabled=True, maxTouchPoints=5)

    async def touch(self, what: str, *, right: float = 0.0, up: float = 0.0) -> None:
        """Touch the middle of an element (a CSS selector), then draw the finger so many pixels away, and keep it there.

        Nobody waits for a page that does not answer.
        """
        box = json.loads(
            await self.evaluate(f"JSON.stringify(document.querySelector({what!r}).getBoundingClientRect())")
        )
        x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
        await self._touch("touchStart", [{"x": x, "y": y}])
        if right or up:
            for share in (0.3, 0.6, 1.0):
                await self._touch("touchMove", [{"x": x + right * share, "y": y - up * share}])

    async def lift(self) -> None:
        """Lift the finger."""
        await self._touch("touchEnd", [])

    async def lose_focus(self) -> None:
        """Tell the page what another window that takes the focus tells it: without a display there is none."""
        await self.evaluate("dispatchEvent(new Event('blur'))")

    async def hide(self) -> None:
        """Open another tab in front of the page."""
        await self.call("Emulation.setFocusEmulationEnabled", enabled=False)
        await self._send("Target.createTarget", {"url": "about:blank"})

    async def show(self) -> None:
        """Choose its tab again."""
        await self.call("Page.bringToFront")
        await self.call("Emulation.setFocusEmulationEnabled", enabled=True)

    async def freeze(self) -> None:
        """Freeze the page, as browsers do with a tab that nobody sees."""
        await self.call("Emulation.setFocusEmulationEnabled", enabled=False)
        await self._send("Page.setWebLifecycleState", {"state": "frozen"})

    def signal_pages(self, number: signal.Signals) -> None:
        """Send a signal to the processes of its pages."""
        for pid in _descendants(self.process.pid):
            with suppress(FileNotFoundError, ProcessLookupError):
                if b"--type=renderer" in Path(f"/proc/{pid}/cmdline").read_bytes():
                    os.kill(pid, number)

    async def _touch(self, kind: str, points: list[dict[str, float]]) -> None:
        await self._send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})

    async def picture(self) -> bytes:
        """Return a PNG of the page."""
        return base64.b64decode((await self.call("Page.captureScreenshot"))["data"])

    async def _read(self) -> None:
        async for message in self._socket:
            packet = message.json()
            if "id" in packet:
                self._answers.pop(packet["id"]).set_result(packet.get("result", {}))
                continue
            self._note(packet["method"], packet["params"])

    def _note(self, method: str, told: dict[str, Any]) -> None:
        """Note an event of the page."""
        if method.startswith("Network.webSocketFrame"):
            data = told["response"]["payloadData"] if "response" in told else ""
            self.on_frame(*((data, "") if method.endswith("Received") else ("", data)))
            return
        match method:
            case "Network.requestWillBeSent":
                self.requests.append(told["request"]["url"])
            case "Network.webSocketCreated":
                self.requests.append(told["url"])
            case "Network.loadingFailed":
                self.problems.append(str(told))
            case "Runtime.exceptionThrown":
                self.problems.append(str(told["exceptionDetails"]))
            case "Log.entryAdded" if told["entry"]["level"] == "error":
                self.problems.append(f"{told['entry'].get('url')}: {told['entry']['text']}")


def _descendants(pid: int) -> list[int]:
    try:
        found = children(pid)
    except (FileNotFoundError, ProcessLookupError):  # it has ended meanwhile
        return []
    return [*found, *(each for child in found for each in _descendants(child))]


def _key(kind: str, key: str) -> dict[str, Any]:
    return {"type": kind, "key": key, "code": CODES[key], "windowsVirtualKeyCode": ord(key.upper())}


async def pause(seconds: float) -> None:
    """Let time pass without blocking the loop."""
    done = asyncio.Event()
    asyncio.get_running_loop().call_later(seconds, done.set)
    await done.wait()


async def eventually(condition: Callable[[], object], process: subprocess.Popen[bytes] | None = None) -> None:
    """Wait until the condition is true."""
    async with asyncio.timeout(PATIENCE):
        while not condition():
            assert process is None or process.poll() is None, "it has ended"
            await pause(0.02)
