"""The mouse off Drive: tabs, rows, keys of the footer, the wheel. Nothing that it does reaches a vehicle."""

from __future__ import annotations

import pytest

from groundstation.intents.watch import Watch
from groundstation.screens import SCREENS, ScreenRow
from groundstation.snapshot import LogLine
from groundstation.ui.app.help import HelpScreen
from groundstation.ui.app.navigation import load_screen
from groundstation.ui.base.screen import ConsoleScreen
from groundstation.ui.charts.screen import ChartsScreen
from groundstation.ui.log.screen import LogScreen
from groundstation.ui.messages.screen import MessagesScreen
from groundstation.ui.params.screen import ParamsScreen
from groundstation.ui.setup.screen import SetupScreen
from groundstation.views.log import LogPage
from tests.groundstation.ui import example_params
from tests.groundstation.ui.examples import NOON, snapshot, vehicle
from tests.groundstation.ui.pilots import Console, console, type_in
from tests.waits import until

OTHERS = [row for row in SCREENS if row.id != "drive"]
TABS = 1
"""Row of the tab bar."""

LINES = LogPage(
    tuple(LogLine(time=NOON, severity=6, label="vehicle", text=f"line {n}.", number=n) for n in range(1, 101)), 100
)


async def open_screen(screen: Console, row: ScreenRow) -> ConsoleScreen:
    screen.app._navigator.open(row)
    await until(lambda: isinstance(screen.app.screen, load_screen(row)))
    await screen.pilot.pause()
    top = screen.app.screen
    assert isinstance(top, ConsoleScreen)
    return top


async def point(screen: Console, column: int, row: int, button: int = 0) -> None:
    """Send the report of a press as a terminal does, and that of its release."""
    type_in(screen, f"\x1b[<{button};{column + 1};{row + 1}M\x1b[<{button};{column + 1};{row + 1}m")
    await screen.pilot.pause()


async def click_on(screen: Console, text: str, *, last: bool = False) -> None:
    lines = screen.text.splitlines()
    rows = [at for at, line in enumerate(lines) if text in line]
    row = rows[-1 if last else 0]
    await point(screen, lines[row].index(text) + 1, row)


def sent(screen: Console) -> list[object]:
    return [each for each in screen.station.wishes if not isinstance(each, Watch)]


ARMED = snapshot(vehicle=vehicle(mode="AUTO", armed=True))


@pytest.mark.parametrize("row", OTHERS, ids=lambda row: row.id)
async def test_no_click_and_no_wheel_reaches_a_vehicle(row: ScreenRow) -> None:
    async with console((100, 30), ARMED) as screen:
        await open_screen(screen, row)
        before = sent(screen)
        for line in (0, *range(2, 28, 4), 28, 29):
            for column in range(1, 100, 5 if line == 29 else 33):
                for button in (64, 65, 0):
                    type_in(screen, f"\x1b[<{button};{column + 1};{line + 1}M")
                await screen.pilot.pause()
                if not isinstance(screen.app.screen, load_screen(row)):
                    await open_screen(screen, row)
        unwanted = [each for each in sent(screen)[len(before) :] if type(each).__name__ not in HARMLESS]
        assert unwanted == []


HARMLESS = {"Stop", "PinSeries", "WatchDiscovery", "StartSimulator", "ListFolder"}
"""Neutral of our own keys when Drive is left, and what asks for data: fields, files, the network, a new simulator."""


async def test_on_drive_the_mouse_does_nothing() -> None:
    async with console((100, 30), ARMED) as screen:
        before = list(sent(screen))
        for line in range(30):
            for column in range(0, 100, 7):
                for button in (0, 64, 65):
                    type_in(screen, f"\x1b[<{button};{column + 1};{line + 1}M")
        await screen.pilot.pause()
        assert screen.app.screen is screen.app.drive
        assert sent(screen) == before
        assert screen.app.gate.closure is None


async def test_a_click_on_a_tab_opens_its_screen() -> None:
    async with console((140, 30)) as screen:
        await open_screen(screen, SCREENS[5])
        await click_on(screen, "F5 Charts")
        await until(lambda: isinstance(screen.app.screen, ChartsScreen))
        await click_on(screen, "F1 Drive")
        await until(lambda: screen.app.screen is screen.app.drive)


async def test_a_click_and_the_wheel_move_in_the_log() -> None:
    async with console((100, 30)) as screen:
        top = await open_screen(screen, SCREENS[5])
        assert isinstance(top, LogScreen)
        screen.station.offer_view(LINES)
        await screen.show(snapshot())
        await until(lambda: "line 100." in screen.text)
        await click_on(screen, "line 95.")
        assert "›" in next(line for line in screen.text.splitlines() if "line 95." in line)
        await point(screen, 40, 20, 64)
        assert "›" in next(line for line in screen.text.splitlines() if "line 92." in line)
        await point(screen, 40, 20, 65)
        assert "›" in next(line for line in screen.text.splitlines() if "line 95." in line)


async def test_a_click_chooses_a_parameter_and_its_panel() -> None:
    views, _ = example_params.STATES["groups"]
    async with console((140, 45)) as screen:
        top = await open_screen(screen, SCREENS[3])
        assert isinstance(top, ParamsScreen)
        for _ in range(2):
            for view in views:
                screen.station.offer_view(view)
            await screen.show(snapshot())
        assert top._model.page is not None
        name = top._model.page.rows[2].name
        await click_on(screen, name)
        assert top._model.selected is not None
        assert top._model.selected.name == name


async def test_a_click_on_a_key_of_the_footer_presses_it() -> None:
    async with console((140, 30)) as screen:
        top = await open_screen(screen, SCREENS[2])
        assert isinstance(top, MessagesScreen)
        await click_on(screen, "z Freeze")
        assert "FROZEN" in screen.text
        await click_on(screen, "/ Filter")
        assert top.takes_text
        await click_on(screen, "F5 Charts")
        assert screen.app.screen is top, "a text field keeps what is typed"


async def test_a_key_that_reaches_the_vehicle_is_not_pressed() -> None:
    async with console((140, 30), ARMED) as screen:
        top = await open_screen(screen, SCREENS[7])
        assert isinstance(top, SetupScreen)
        before = sent(screen)
        for label in ("c Check", "m Motors", "B Reboot", "SPACE Stop", "! E-STOP"):
            await click_on(screen, label, last=True)
        assert sent(screen) == before
        assert top.question is None


async def test_a_question_is_not_answered_by_a_click() -> None:
    async with console((100, 30)) as screen:
        top = await open_screen(screen, SCREENS[5])
        asked: list[bool] = []
        top.ask("do it", lambda: asked.append(True))
        await click_on(screen, "a All")
        assert top.question is not None
        assert asked == []


async def test_the_wheel_scrolls_the_help() -> None:
    async with console((100, 24)) as screen:
        await screen.press("question_mark")
        assert isinstance(screen.app.screen, HelpScreen)
        first = screen.text
        await point(screen, 30, 10, 65)
        assert screen.text != first
        await point(screen, 30, 10, 64)
        assert screen.text == first
