"""A tab of Chromium as a terminal for a pupil: its keyboard types, and what the page is sent is shown by tmux."""

from __future__ import annotations

import asyncio
import base64
import json
import threading
from collections.abc import Coroutine, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from tests.e2e.chromium import Browser
from tests.e2e.test_in_tmux import Tmux
from tests.waits import PATIENCE

PAGE = (760, 680)
"""Pixels: a terminal somewhat larger than 80x24. A small page draws faster without a graphics card."""
LIFTED = 0.5
"""s after its newest repeat at which a held key is let go: less than the pause of whoever lets it go, and more than the
time between two repeats on a late machine."""
KEYS = {"Space": " ", "BSpace": "Backspace", "Up": "ArrowUp", "Down": "ArrowDown", "Left": "ArrowLeft",
        "Right": "ArrowRight", "\\;": ";"}  # fmt: skip
"""tmux's name of a key -> that of a browser, where they differ."""
TEXTS = {"Enter": "\r", "Tab": "\t"}
"""What named keys type."""
PLACES = {"/": "Slash", "?": "Slash", ",": "Comma", "<": "Comma", ".": "Period", ">": "Period", "-": "Minus",
          "_": "Minus", ";": "Semicolon", "[": "BracketLeft", "]": "BracketRight", " ": "Space"}  # fmt: skip
"""Character -> its place on a US keyboard; letters and digits have it in their name."""
SHIFTED = "?<>_"
CTRL, SHIFT = 2, 8


class Keyboard:
    """Presses keys as a hand does."""

    def __init__(self, browser: Browser) -> None:
        self._browser = browser
        self._down = ""
        self._lift: asyncio.TimerHandle | None = None
        self._sending = asyncio.Lock()

    async def press(self, keys: Sequence[str], held: bool) -> None:
        """Press keys by tmux's names, and let go. One that is held stays down for LIFTED s, and repeats meanwhile."""
        async with self._sending:
            if self._lift is not None:
                self._lift.cancel()
            for key in keys:
                if not held or key != self._down:
                    await self._release()
                await self._browser.send_key("keyDown", autoRepeat=key == self._down, **_event(key, types=True))
                self._down = key
            if not held:
                await self._release()
                return
            self._lift = asyncio.get_running_loop().call_later(LIFTED, lambda: asyncio.ensure_future(self._let_go()))

    async def _let_go(self) -> None:
        async with self._sending:
            await self._release()

    async def _release(self) -> None:
        if self._down:
            await self._browser.send_key("keyUp", **_event(self._down, types=False))
        self._down = ""


def _event(key: str, *, types: bool) -> dict[str, Any]:
    modifiers = CTRL if key.startswith("C-") else 0
    name = KEYS.get(key, key.removeprefix("C-"))
    if (name.isupper() and len(name) == 1) or name in SHIFTED:
        modifiers |= SHIFT
    place = f"Key{name.upper()}" if name.isalpha() else f"Digit{name}" if name.isdecimal() else PLACES.get(name, name)
    event: dict[str, Any] = {"key": name, "code": place if len(name) == 1 else name, "modifiers": modifiers}
    text = TEXTS.get(name, name if len(name) == 1 else "")
    return event | ({"text": text} if types and text and not modifiers & CTRL else {})


@contextmanager
def tab_of(folder: Path, url: str) -> Iterator[Tmux]:
    """Open an address in Chromium; return a terminal that shows its tab, and types there."""
    loop = asyncio.new_event_loop()
    thread = threading.Thread(target=loop.run_forever, daemon=True)
    thread.start()

    def wait(work: Coroutine[Any, Any, Any]) -> Any:
        return asyncio.run_coroutine_threadsafe(work, loop).result(PATIENCE)

    drawn = folder / "drawn"
    drawn.touch()
    picture = Tmux(folder, 80, 24, shows=drawn)

    def note(received: str, sent: str) -> None:
        if sent.startswith('["resize"'):
            size = json.loads(sent)[1]
            picture.resize(size["width"], size["height"])
        elif received:
            with drawn.open("ab") as file:
                file.write(base64.b64decode(received))

    browser = wait(_open(folder, url, note))
    keyboard = Keyboard(browser)
    picture.send_keys = lambda keys, held: wait(keyboard.press(keys, held))
    try:
        yield picture
    finally:
        wait(browser.__aexit__())
        loop.call_soon_threadsafe(loop.stop)
        thread.join()
        loop.close()
        picture.end()


async def _open(folder: Path, url: str, note: Any) -> Browser:
    browser = Browser(folder, PAGE)
    browser.on_frame = note
    await browser.__aenter__()
    await browser.open(url)
    return browser
