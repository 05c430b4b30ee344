"""Draws docs/browser.png: the Drive screen in a tab of Chromium while a simulated rover is driven. `python -m`."""

from __future__ import annotations

import asyncio
import tempfile
from contextlib import ExitStack
from pathlib import Path

from tests.e2e.chromium import Browser, pause
from tests.e2e.test_browser import Rig, drive

TARGET = Path(__file__).parents[2] / "docs" / "browser.png"
SIZE = (1200, 760)


async def draw(rig: Rig, folder: Path) -> bytes:
    """Take the keys, arm, drive a curve, and return the picture."""
    async with Browser(folder, SIZE) as browser:
        await browser.open(rig.url)
        await pause(1.0)
        await browser.press("g")
        await browser.release("g")
        await drive(rig, browser)
        for key in ("u", "i"):
            await browser.hold(key, lambda: False, 3.0)
        return await browser.picture()


def main() -> None:
    """Start a station and a rover, and write the picture."""
    with ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        TARGET.write_bytes(asyncio.run(draw(Rig(folder, stack), folder)))


if __name__ == "__main__":
    main()
