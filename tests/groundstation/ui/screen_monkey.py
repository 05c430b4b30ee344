"""Presses anything on every screen, with a simulated rover behind a real station: only Drive drives, stops stop.

python -m tests.groundstation.ui.screen_monkey --minutes 10 --seed 1

Keys, text, escape sequences whole and in pieces, and sizes from 20x5 to 200x60, by a seed. Time is virtual.
"""

from __future__ import annotations

import argparse
import asyncio
import math
import os
import random
import time
from collections import Counter
from collections.abc import Awaitable, Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from textual.pilot import Pilot

from dialects.messages import ManualControl, RoverOperatorPresence
from groundstation.input.keymap import KEYMAPS, Keymap
from groundstation.intents.session import SetKeyGate
from groundstation.intents.union import AnyIntent
from groundstation.screens import SCREENS
from groundstation.ui.app.app import ConsoleApp
from groundstation.ui.terminal.key_parser import KeyEventParser
from tests.groundstation.held_key import event_times
from tests.groundstation.ui.live_station import LiveStation
from tests.test_stop_monkey import moves
from tests.test_stops import NEUTRAL_WITHIN, Drive
from vehicle.safety.states import SafetyState

LEAVES = "\x03\x11\x1a"
"""^c, ^q and ^z end or suspend the program."""
LETTERS = [chr(code) for code in range(1, 127) if chr(code) not in LEAVES]
SEQUENCES = (
    "\x1b[A", "\x1b[B", "\x1b[C", "\x1b[D", "\x1b[H", "\x1b[F", "\x1b[5~", "\x1b[6~", "\x1b[3~", "\x1b[Z",
    "\x1bOP", "\x1bOQ", "\x1bOR", "\x1bOS", "\x1b[15~", "\x1b[17~", "\x1b[18~", "\x1b[19~", "\x1b[20~",
    "\x1b[105;1:1;105u", "\x1b[105;1:2;105u", "\x1b[105;1:3u", "\x1b[49;1:1;49u", "\x1b[<64;5;5M", "\x1b[M !!",
    "\x1b[200~i3yr\x1b[201~", "\x1b]0;title\x07", "\x1b[999z", "\x1b3", "\x1bi", "\x1b[", "\x1bO", "\x1b[1;5",
)  # fmt: skip
"""Keys as a terminal sends them, with kitty's presses, repeats and releases, the mouse, a paste, and noise."""
TEXTS = ("throttle", "-35.36 149.16", "12:04:10", "*?[(\\", "ü–漢", "yes", "erase", "y", "1e999", "")
GAPS = (0.0, 0.03, 0.15, 0.5, 1.2)
"""s between two acts, and between the pieces of a sequence."""
STOP, EMERGENCY, DRIVE_SCREEN = "\x0b", "!", "\x1b\x1bOP"
SETTLED = 0.5
"""s after which a vehicle that was told to stop has received it and ramped down: more than the bound."""


class WatchedStation(LiveStation):
    """Checks each demand: none that moves is sent while the screen keeps its keys from driving."""

    def __init__(self, drive: Drive) -> None:
        super().__init__(drive)
        self.closed_at = math.inf
        self._seen = 0
        self.turned = 0
        """How often a demand that moves was sent."""

    def handle(self, *intents: AnyIntent) -> None:
        """Note when the gate closes."""
        for intent in intents:
            if isinstance(intent, SetKeyGate):
                self.closed_at = math.inf if intent.open else self.drive.world.now
        super().handle(*intents)

    def run(self, seconds: float) -> None:
        """Let time pass and look at what was sent."""
        super().run(seconds)
        sent = self.drive.world.near.sent
        for at, message in sent[self._seen :]:
            if isinstance(message, (ManualControl, RoverOperatorPresence)) and moves(message):
                self.turned += 1
                assert at <= self.closed_at, f"a demand {at - self.closed_at:.2f} s after the gate was closed"
        self._seen = len(sent)


class ScreenMonkey:
    """One app on one rover."""

    def __init__(self, app: ConsoleApp, station: WatchedStation, pilot: Pilot[int], chance: random.Random) -> None:
        self._app, self._station, self._pilot, self._chance = app, station, pilot, chance
        self._parser = KeyEventParser(app.gate, clock=self._now)
        self.acts: list[str] = []
        """What was done, the newest last."""

    def _now(self) -> float:
        return self._station.drive.world.now

    @property
    def ended(self) -> bool:
        """The program was left, as by the palette."""
        return self._app.return_code is not None

    async def act(self) -> None:
        """Do one thing, and let some time pass."""
        choices: tuple[tuple[Callable[[], Awaitable[None]], int], ...] = (
            (self._press, 30), (self._visit, 10), (self._type, 5), (self._split, 8), (self._resize, 3),
            (self._drive, 5), (self._stop, 4), (self._emergency, 1),
        )  # fmt: skip
        acts, weights = zip(*choices, strict=True)
        await self._chance.choices(acts, weights)[0]()
        await self._pass(self._chance.choice(GAPS))

    async def _feed(self, data: str) -> None:
        """Type in one read of the terminal, and let the app handle it."""
        self._type_in(data)
        await self._pass(0.0)

    def _type_in(self, data: str) -> None:
        self.acts = [*self.acts[-40:], repr(data)]
        for event in self._parser.feed(data):
            event.set_sender(self._app)
            self._app.post_message(event)

    async def _pass(self, seconds: float) -> None:
        self._station.run(seconds)
        for event in self._parser.tick():
            event.set_sender(self._app)
            self._app.post_message(event)
        await self._pilot.pause()

    async def _press(self) -> None:
        keys = [self._chance.choice(LETTERS if self._chance.random() < 0.7 else SEQUENCES) for _ in range(3)]
        await self._feed("".join(keys[: self._chance.randint(1, 3)]))

    async def _visit(self) -> None:
        row = self._chance.choice([row for row in SCREENS if row.in_tabs])
        await self._feed("\x07" + row.digit)

    async def _type(self) -> None:
        await self._feed(self._chance.choice((":", "/", "\r")) + self._chance.choice(TEXTS))
        await self._feed(self._chance.choice(("\r", "\x1b", "")))

    async def _split(self) -> None:
        sequence = self._chance.choice(SEQUENCES)
        at = self._chance.randrange(1, len(sequence))
        await self._feed(sequence[:at])
        await self._pass(self._chance.choice(GAPS))
        await self._feed(sequence[at:])

    async def _resize(self) -> None:
        size = self._chance.choice(((20, 5), (40, 10), (80, 24), (119, 30), (140, 45), (200, 60)))
        self.acts.append(f"resize {size}")
        await self._pilot.resize_terminal(*size)

    async def _drive(self) -> None:
        """Go back to Drive, clear an emergency stop, arm, drive."""
        await self._feed(DRIVE_SCREEN)
        await self._pass(2.0)
        for key, seconds in (("t", 1.4), ("1", 0.0), ("r", 1.4), ("i", self._chance.random() * 2)):
            if key != "r" or self._station.drive.rover.state is not SafetyState.ARMED:
                await self._hold(key, seconds)

    async def _hold(self, key: str, seconds: float) -> None:
        began = self._now()
        for at in event_times(seconds):
            await self._pass(max(0.0, began + at - self._now()))
            self._type_in(key)
        await self._pass(0.0)

    async def _stop(self) -> None:
        await self._feed(STOP)
        await self._pass(NEUTRAL_WITHIN + SETTLED)
        drive = self._station.drive
        assert drive.power == 0.0, f"turns after a stop, in {drive.rover.state}"

    async def _emergency(self) -> None:
        await self._feed(EMERGENCY)
        await self._pass(SETTLED)
        drive = self._station.drive
        assert drive.power == 0.0
        assert drive.rover.state is not SafetyState.ARMED


async def rampage(seed: int, acts: int, folder: Path) -> Counter[str]:
    """Act so often on one app; return how often each screen was seen, and under "turned" how often it drove."""
    drive = Drive()
    drive.get_going()
    drive.held = None
    drive.run(2.0)
    station = WatchedStation(drive)
    app = ConsoleApp(
        station.screen, Keymap("standard", KEYMAPS["standard"]), folder=folder, clock=lambda: drive.world.now
    )
    seen: Counter[str] = Counter()
    try:
        async with app.run_test(size=(100, 30)) as pilot:
            monkey = ScreenMonkey(app, station, pilot, random.Random(seed))
            try:
                for _ in range(acts):
                    if monkey.ended:
                        break
                    await monkey.act()
                    seen[type(app.screen).__name__] += 1
            except BaseException:
                print(f"seed {seed}, the last acts: {' '.join(monkey.acts)}")
                raise
    finally:
        station.screen.close()
    seen["turned"] = station.turned
    return seen


@contextmanager
def _own_folders() -> Iterator[Path]:
    """Keep favourites and recent endpoints of the user out of it."""
    with TemporaryDirectory() as name:
        os.environ["XDG_STATE_HOME"] = os.environ["XDG_CONFIG_HOME"] = name
        yield Path(name)


def main() -> int:
    """Run it for a time, a new app every 300 acts."""
    parser = argparse.ArgumentParser(description="Press anything on every screen; only Drive may drive.")
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    end, seed, seen = time.monotonic() + options.minutes * 60, options.seed, Counter[str]()
    with _own_folders() as folder:
        while time.monotonic() < end:
            seen += asyncio.run(rampage(seed, 300, folder))
            seed += 1
    print(f"seeds {options.seed} to {seed - 1}: " + ", ".join(f"{name} {count}" for name, count in seen.most_common()))
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
