"""Types and pastes prose, source code and mouse reports into the real console: nothing of that may arm.

python -m tests.groundstation.ui.typing_monkey --minutes 10 --seed 1
"""

from __future__ import annotations

import argparse
import asyncio
import random
from collections.abc import Awaitable, Callable
from pathlib import Path
from tempfile import TemporaryDirectory

from groundstation.intents.driving import ClearEmergencyStop
from groundstation.intents.vehicle import Arm
from groundstation.ui.app.app import ConsoleApp
from tests.groundstation.held_key import hold_until
from tests.groundstation.ui.examples import Recorder, snapshot, vehicle
from tests.groundstation.ui.ptys import Terminal, app_on_a_pty
from tests.waits import until

FOLDER = Path(__file__).parents[3]

PAIRS = "cat directory using udp; please retry the query now; try very binary entry; carry, hurry, sorry, mirror\n"
"""Words with r, y, rr and t."""

REPORTS = ("\x1b[<64;11;12M", "\x1b[<0;20;5M\x1b[<0;20;5m", "\x1b[M`ir", "\x1b[M !y")

F1 = "\x1bOP"

GAPS = (0.005, 0.03, 0.06, 0.12, 0.25)
"""s between two keys: a script, an auto-repeat, a fast and a slow typist."""


def corpus() -> str:
    """Return the documents and the source code of the project, without control characters."""
    files = (
        FOLDER / "README.md",
        FOLDER / "docs" / "safety.md",
        FOLDER / "groundstation" / "actions.py",
        Path(__file__),
    )
    text = "".join(PAIRS + file.read_text("utf-8") for file in files)
    return "".join(each for each in text if each == "\n" or each.isprintable())


class Monkey:
    """Types pieces of a text in several ways, by a seed."""

    def __init__(self, terminal: Terminal, seed: int) -> None:
        self._terminal, self._chance, self._text = terminal, random.Random(seed), corpus()

    async def run(self, seconds: float) -> None:
        """Act for so many s."""
        acts: tuple[Callable[[], Awaitable[None]], ...] = (
            self._type,
            self._type,
            self._paste,
            self._bracket,
            self._mix,
        )
        loop = asyncio.get_running_loop()
        end = loop.time() + seconds
        while loop.time() < end:
            await self._chance.choice(acts)()

    def _piece(self, longest: int) -> str:
        start = self._chance.randrange(len(self._text))
        return self._text[start : start + self._chance.randint(1, longest)]

    async def _type(self) -> None:
        await self._terminal.type_each(self._piece(40), self._chance.choice(GAPS))

    async def _paste(self) -> None:
        """Paste without brackets, in a few writes."""
        piece, size = self._piece(600), self._chance.randint(1, 300)
        parts = [piece[at : at + size] for at in range(0, len(piece), size)]
        await self._terminal.type_each(parts, self._chance.choice(GAPS[:3]) if size > 5 else GAPS[0])

    async def _bracket(self) -> None:
        await self._terminal.type_each([f"\x1b[200~{self._piece(300)}", "\x1b[201~"], self._chance.choice(GAPS))

    async def _mix(self) -> None:
        """Type, with the mouse used in between."""
        mixed = [self._chance.choice((*REPORTS, self._piece(3), "r", "y", "rr")) for _ in range(20)]
        await self._terminal.type_each(mixed, self._chance.choice(GAPS))


async def rampage(seconds: float, seed: int) -> int:
    """Show that a held key arms, type for so many s, show it again. Return how often the text armed."""
    with TemporaryDirectory() as folder:  # "[" opens the log, where "S" saves
        return await _rampage(seconds, seed, Path(folder))


async def _rampage(seconds: float, seed: int, folder: Path) -> int:
    async with app_on_a_pty(folder=folder) as (app, station, terminal):
        station.offer(snapshot(vehicle=vehicle(armed=False)))
        await until(lambda: app.drive.snapshot.vehicle is not None)
        await _hold_arms(app, station, terminal)
        before = _confirmed(station)
        await Monkey(terminal, seed).run(seconds)
        by_text = _confirmed(station) - before
        await _hold_arms(app, station, terminal)
        return by_text


async def _hold_arms(app: ConsoleApp, station: Recorder, terminal: Terminal) -> None:
    async def press() -> None:
        terminal.type("r")

    def is_open() -> bool:
        if app.gate.closure is not None:
            terminal.type(F1)  # leaves the help, the log and its filter
        return app.gate.closure is None

    await until(is_open)
    before = len(station.of(Arm))
    await hold_until(press, lambda: len(station.of(Arm)) > before)


def _confirmed(station: Recorder) -> int:
    return len(station.of(Arm)) + len(station.of(ClearEmergencyStop))


def main() -> int:
    """Run it and report."""
    parser = argparse.ArgumentParser(description="Type and paste text into the console; it must not arm.")
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    by_text = asyncio.run(rampage(options.minutes * 60, options.seed))
    print(f"{options.minutes:g} minutes, seed {options.seed}: a held key armed before and after, text {by_text} times")
    return min(by_text, 1)


if __name__ == "__main__":
    raise SystemExit(main())
