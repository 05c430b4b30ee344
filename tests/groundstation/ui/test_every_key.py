"""Each key of the action table on each screen, in text fields and under questions: only Drive lets a push through.

The wheels are those of the simulated rover behind a real station, and they turn before and after.
"""

from __future__ import annotations

import contextlib
from collections.abc import AsyncIterator, Callable

import pytest
from textual.pilot import Pilot

from groundstation.actions import ACTIONS
from groundstation.input.keymap import KEYMAPS, Keymap
from groundstation.input.style import Style
from groundstation.intents.driving import DriveKeyDown, EmergencyStop, Stop
from groundstation.screens import SCREENS, ScreenRow
from groundstation.ui.app.app import ConsoleApp
from groundstation.ui.app.navigation import load_screen
from groundstation.ui.base.screen import ConsoleScreen
from groundstation.ui.terminal.key_parser import KeyEventParser
from groundstation.ui.widgets.line_field import FieldUse
from tests.groundstation.ui import frames
from tests.groundstation.ui.live_station import LiveStation
from tests.groundstation.ui.settling import paint_changes, painted_when_seen
from tests.test_stops import Drive
from vehicle.safety.states import SafetyState

OTHERS = [row for row in SCREENS if row.in_tabs and row.id != "drive"]
BYTES = {
    "up": "\x1b[A", "down": "\x1b[B", "right": "\x1b[C", "left": "\x1b[D", "comma": ",", "full_stop": ".", "space": " ",
    "ctrl+k": "\x0b", "ctrl+y": "\x19", "exclamation_mark": "!", "f1": "\x1bOP",
}  # fmt: skip
"""Bytes of keys whose name is not the byte."""

LEAVING = ("app", "stop")
"""Groups of actions that leave the screen, or stop: tested on their own."""

RELEASING = "vehicle.release"
"""Ends control of the rover, on the Links screen, too: it would not drive afterwards."""


class Wheels:
    """The app, and the rover behind it."""

    def __init__(self, app: ConsoleApp, station: LiveStation, pilot: Pilot[int]) -> None:
        self.app, self.station, self.pilot = app, station, pilot

    async def type(self, data: str) -> None:
        """Type in one read of the terminal; let the app and 0.1 s of the rover pass."""
        for event in KeyEventParser(self.app.gate).feed(data):
            event.set_sender(self.app)
            self.app.post_message(event)
        await self.pass_time(0.1)

    async def pass_time(self, seconds: float) -> None:
        self.station.run(seconds)
        await self.pilot.pause()

    async def until(self, condition: Callable[[], bool]) -> None:
        """Let time pass until something is true: at most 10 s of the rover."""
        for _ in range(200):
            if condition():
                return
            await self.pass_time(0.05)
        raise AssertionError("not within 10 s")

    @property
    def power(self) -> float:
        return self.station.drive.power

    @property
    def screen(self) -> ConsoleScreen:
        assert isinstance(self.app.screen, ConsoleScreen)
        return self.app.screen

    async def open(self, row: ScreenRow) -> None:
        await self.type("\x07")
        await self.type(row.digit)
        await self.until(lambda: isinstance(self.app.screen, load_screen(row)))
        await self.until(lambda: self.app.gate.closure is not None)
        await self.pass_time(1.0)
        assert self.power == 0.0


@contextlib.asynccontextmanager
async def driving_wheels() -> AsyncIterator[Wheels]:
    """An armed rover whose wheels have turned by a key of this screen."""
    drive = Drive()
    drive.get_going()
    drive.held = None
    drive.run(2.0)
    station = LiveStation(drive)
    app = ConsoleApp(station.screen, Keymap("standard", KEYMAPS["standard"]))
    try:
        with painted_when_seen(app):
            async with app.run_test(size=(100, 30)) as pilot:
                wheels = Wheels(app, station, pilot)
                await wheels.until(lambda: app.gate.closure is None)
                await drives(wheels)
                yield wheels
                paint_changes(app.screen)
    finally:
        station.screen.close()


async def drives(wheels: Wheels) -> None:
    """Check that a key drives on Drive, and that it ends."""
    await wheels.pass_time(1.5)
    await wheels.type("i")
    await wheels.pass_time(0.2)
    assert wheels.power > 0.2
    await wheels.pass_time(2.0)
    assert wheels.power == 0.0


def action_keys() -> list[str]:
    keys = [
        key
        for action in ACTIONS.values()
        if action.group not in LEAVING and action.id != RELEASING
        for key in Keymap("standard", KEYMAPS["standard"]).get_keys(action.id)
    ]
    return [BYTES.get(key, key) for key in keys if len(BYTES.get(key, key)) == 1 or key in BYTES]


def open_field(screen: ConsoleScreen) -> None:
    screen.field.open(FieldUse(lambda text: None))


def ask(screen: ConsoleScreen) -> None:
    screen.ask("erase all logs", lambda: None)


def ask_word(screen: ConsoleScreen) -> None:
    screen.ask("erase all logs", lambda: None, word="erase")


STATES: dict[str, Callable[[ConsoleScreen], None]] = {"field": open_field, "question": ask, "word": ask_word}


@pytest.mark.parametrize("row", OTHERS, ids=lambda row: row.id)
async def test_keys_drive_nothing_on_another_screen_and_stops_stop(row: ScreenRow) -> None:
    async with driving_wheels() as wheels:
        await wheels.open(row)
        for data in action_keys():
            await wheels.type(data * 3)
            assert wheels.power == 0.0, data
            assert wheels.station.drive.rover.state is SafetyState.ARMED, data
            if not isinstance(wheels.app.screen, load_screen(row)):  # a key of this screen has opened another one
                await wheels.open(row)
        for opening in STATES.values():
            for data in ("i", "\x1b[A", " ", "1", "r"):
                opening(wheels.screen)
                await wheels.type(data)
                assert wheels.power == 0.0, data
        assert any(isinstance(each, DriveKeyDown) for each in wheels.station.screen.intents)
        await wheels.type("\x1b")
        await wheels.type("\x1bOP")
        await wheels.until(lambda: wheels.app.screen is wheels.app.drive)
        await wheels.until(lambda: wheels.app.gate.closure is None)
        await wheels.type("1")  # the 2 of the Map screen is HOLD, as that of Drive
        await wheels.pass_time(0.5)
        await drives(wheels)
        await wheels.open(row)
        await stops_stop(wheels)


async def test_tab_on_drive_keeps_the_style_and_says_so() -> None:
    """TAB chooses panels on the other screens: no key of theirs may make a key on Drive go on by itself."""
    async with driving_wheels() as wheels:
        await wheels.type("\t")
        hint = "no panels to choose on this screen; ^y: drive style"
        await wheels.until(lambda: hint in frames.text(wheels.app))
        await drives(wheels)
        sticks = wheels.station.drive.station.operator.sticks
        assert sticks.style.value == "hold"
        while sticks.style is not Style.LATCH:  # the key does change it
            await wheels.type("\x19")
            await wheels.pass_time(1.0)
        await wheels.type("i")
        await wheels.pass_time(4.0)
        assert wheels.power > 0.2
        await wheels.type("k")
        await wheels.pass_time(1.0)
        assert wheels.power == 0.0


def test_no_screen_has_the_key_of_the_style() -> None:
    for name in KEYMAPS:
        styles = Keymap(name, KEYMAPS[name]).get_keys("drive.style")
        assert len(styles) == 1
        for row in OTHERS:
            assert not {each.key for each in load_screen(row).KEYS} & set(styles), row.id


async def stops_stop(wheels: Wheels) -> None:
    """Check the stop keys on this screen, in its text field and under its questions."""
    for data, opening in ((" ", None), ("\x0b", None), *(("\x0b", each) for each in STATES.values())):
        if opening is not None:
            opening(wheels.screen)
        before = wheels.station.screen.intents.count(Stop())
        await wheels.type(data)
        assert wheels.station.screen.intents.count(Stop()) > before, (data, opening)
    for opening in STATES.values():
        opening(wheels.screen)
        before = wheels.station.screen.intents.count(EmergencyStop())
        await wheels.type("!")
        assert wheels.station.screen.intents.count(EmergencyStop()) > before, opening
    await wheels.pass_time(0.5)
    assert wheels.station.drive.rover.state is not SafetyState.ARMED
