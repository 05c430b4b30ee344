"""The thumb stick of a tab on a touch screen drives the real programs in Chromium: what ends a demand, and when.

Each stop first sees the wheels turn.
"""

from __future__ import annotations

import signal
import time
from collections.abc import Awaitable, Callable, Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from groundstation.intents.driving import PAD_WINDOW
from groundstation.web.launch import missing_package
from tests.e2e.chromium import Browser, pause
from tests.e2e.tcp_relay import TcpRelay
from tests.e2e.test_browser import TRY, Rig, needs_chromium
from tests.waits import PATIENCE, Patience

pytestmark = [
    pytest.mark.e2e,
    pytest.mark.xdist_group("browser"),  # several at once starve each other
    pytest.mark.skipif(missing_package() is not None, reason="the extra [web] is not installed"),
    needs_chromium,
]

CONTROL, ARM, STICK = "[data-button=a]", "[data-button=start]", ".stick"


@pytest.fixture
def rig(tmp_path: Path) -> Iterator[Rig]:
    with ExitStack() as stack:
        yield Rig(tmp_path, stack)


class Phone:
    """A browser with a touch screen, behind a network that can be cut, as an SSH tunnel can."""

    def __init__(self, rig: Rig, browser: Browser, network: TcpRelay) -> None:
        self.rig, self.browser, self.network = rig, browser, network

    async def begin(self) -> None:
        """Open the page and take the keys."""
        await self.browser.become_a_phone()
        await self.browser.open(self.rig.url.replace("127.0.0.1", "localhost"))
        assert await self.browser.evaluate("!document.getElementById('touch').hidden")
        await pause(1.0)
        await self._take_control()

    async def _take_control(self) -> None:
        await self.browser.touch(CONTROL)
        await pause(0.2)
        await self.browser.lift()

    async def drive(self) -> None:
        """Arm and push the stick forward until the wheels turn; the finger stays there, and they go on to turn.

        Again, if a busy machine was late with a demand: then it must be lifted.
        """
        rig = self.rig
        patience = Patience(PATIENCE, rig.process.pid, rig.vehicle.process.pid)
        while not rig.relay.armed() or not await self._drives_on():
            assert not patience.ended, rig.vehicle.errors.read_text()
            await self.browser.lift()
            await pause(0.3)
            if rig.relay.armed():
                await self.browser.touch(STICK, up=80)
                await self._wait(rig.vehicle.at_full)
            else:
                await self.browser.touch(ARM)
                await self._wait(rig.relay.armed)
                if not rig.relay.armed():  # the page may have drawn nothing when it was told to take control
                    await self.browser.lift()
                    await self._take_control()

    async def _drives_on(self) -> bool:
        if not self.rig.vehicle.at_full():
            return False
        at = time.monotonic()
        await pause(3 * PAD_WINDOW)
        return all(each.turning for each in self.rig.vehicle.outputs() if each.at > at)

    async def _wait(self, condition: Callable[[], bool]) -> None:
        end = time.monotonic() + TRY
        while not condition() and time.monotonic() < end:
            await pause(0.02)


async def lift(phone: Phone) -> None:
    await phone.browser.lift()


async def kill_the_page(phone: Phone) -> None:
    phone.browser.signal_pages(signal.SIGKILL)


async def kill_the_browser(phone: Phone) -> None:
    phone.browser.kill()


async def freeze_the_page(phone: Phone) -> None:
    phone.browser.signal_pages(signal.SIGSTOP)


async def put_to_sleep(phone: Phone) -> None:
    await phone.browser.freeze()


async def hide(phone: Phone) -> None:
    await phone.browser.hide()


async def show(phone: Phone) -> None:
    await phone.browser.show()


async def cut(phone: Phone) -> None:
    phone.network.cut()


async def drop(phone: Phone) -> None:
    phone.network.drop()


async def go_on(phone: Phone) -> None:
    phone.browser.signal_pages(signal.SIGCONT)


async def join(phone: Phone) -> None:
    phone.network.join()


Act = Callable[[Phone], Awaitable[None]]
Stop = tuple[Act, float, Act | None]
STOPS: dict[str, list[Stop]] = {
    "lifted, frozen, cut, hidden or killed": [
        (lift, 0.0, None),
        (freeze_the_page, PAD_WINDOW, go_on),
        (cut, PAD_WINDOW, join),
        (hide, 0.0, show),
        (kill_the_page, 0.0, None),
    ],
    "killed with its browser": [(kill_the_browser, 0.0, None)],
    "put to sleep": [(put_to_sleep, 0.0, None)],
    "dropped": [(drop, 0.0, None)],
}
"""What happens to one tab, in this order: the act, s until the demand ends, and how it is undone under the finger."""


@pytest.mark.parametrize("stops", STOPS.values(), ids=STOPS)
async def test_the_stick_of_a_tab_drives_until(rig: Rig, tmp_path: Path, stops: list[Stop]) -> None:
    async with TcpRelay(rig.port) as network:
        rules = f"--host-resolver-rules=MAP localhost:{rig.port} 127.0.0.1:{network.port}"
        async with Browser(tmp_path, (390, 844), rules) as browser:
            rig.between.append(browser.process.pid)
            phone = Phone(rig, browser, network)
            await phone.begin()
            assert browser.problems == []
            for act, within, undo in stops:
                await phone.drive()
                await rig.stops(lambda act=act: act(phone), within)  # type: ignore[misc]
                if undo is not None:
                    at = time.monotonic()
                    await undo(phone)
                    await pause(1.5)
                    assert not rig.vehicle.moved_since(at), f"{act.__name__}: it must be lifted first"
