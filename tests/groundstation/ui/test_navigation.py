"""Opening screens of the table and going back."""

from __future__ import annotations

import pytest

from groundstation.actions import ACTIONS
from groundstation.intents.driving import DriveKeyDown, EmergencyStop, Stop
from groundstation.intents.session import SetKeyGate
from groundstation.intents.vehicle import Disarm, RequestControl, SelectNextVehicle, SetMode
from groundstation.screens import SCREENS, ScreenRow
from groundstation.ui.navigation import ROOT, load_screen
from groundstation.ui.screens.drive import DriveScreen
from groundstation.ui.screens.help import HelpScreen
from groundstation.ui.screens.log import LogScreen
from groundstation.ui.screens.screen import ConsoleScreen
from groundstation.ui.widgets.status import StatusBar
from tests.groundstation.ui.extra_screen import ExtraScreen
from tests.groundstation.ui.pilots import Console, console
from tests.groundstation.ui.ptys import until

EXTRA = ScreenRow("extra", "Extra", "One more screen", ("f7",), "7", "tests.groundstation.ui.extra_screen:ExtraScreen")
TABS = [row.id for row in SCREENS if row.in_tabs]
HELP = next(row for row in SCREENS if row.id == "help")


@pytest.mark.parametrize("row", SCREENS, ids=lambda row: row.id)
def test_each_row_names_a_screen(row: ScreenRow) -> None:
    assert issubclass(load_screen(row), ConsoleScreen)


def test_drive_is_the_first_row() -> None:
    assert load_screen(ROOT) is DriveScreen


def open_extra(screen: Console) -> None:
    screen.app._navigator.open(EXTRA)


async def test_a_screen_opens_by_its_key_and_escape_goes_back() -> None:
    async with console() as screen:
        await screen.press("question_mark")
        assert type(screen.app.screen) is load_screen(HELP)
        await screen.press("escape")
        assert screen.app.screen is screen.app.drive


async def test_escape_on_drive_closes_nothing() -> None:
    async with console() as screen:
        await screen.press("escape", "escape")
        assert screen.app.screen is screen.app.drive


@pytest.mark.parametrize("key", ["escape", "f1"])
async def test_a_screen_without_keys_of_its_own_is_left_by_escape_and_by_the_key_of_drive(key: str) -> None:
    async with console() as screen:
        open_extra(screen)
        await screen.pilot.pause()
        assert isinstance(screen.app.screen, ExtraScreen)
        await screen.press(key)
        await until(lambda: screen.app.screen is screen.app.drive)
        await until(lambda: screen.app.gate.closure is None)


async def test_a_screen_opens_instead_of_another_one() -> None:
    async with console() as screen:
        open_extra(screen)
        await screen.pilot.pause()
        await screen.press("question_mark")
        assert [type(each) for each in screen.app.screen_stack[1:]] == [DriveScreen, HelpScreen]
        await screen.press("f1")
        assert screen.app.screen is screen.app.drive


async def test_the_key_of_drive_changes_nothing_on_drive() -> None:
    async with console() as screen:
        await screen.press("f1")
        assert screen.app.screen is screen.app.drive
        assert len(screen.app.screen_stack) == 2


async def test_the_screen_on_top_is_shown_what_drive_is_shown() -> None:
    async with console() as screen:
        open_extra(screen)
        await screen.pilot.pause()
        extra = screen.app.screen
        assert isinstance(extra, ExtraScreen)
        await until(lambda: extra.shown)
        assert extra.shown[-1].snapshot == screen.app.drive.snapshot


async def test_a_screen_shows_the_newest_state_from_its_first_frame_on() -> None:
    async with console() as screen:
        screen.app.perform_action(ACTIONS["app.log"])
        top = screen.app.screen
        assert isinstance(top, LogScreen)
        await until(
            lambda: top.query("#status") and "Rover 1" in top.query_one("#status", StatusBar).draw(80, 1)[0].text
        )
        assert "no vehicle" not in screen.text


@pytest.mark.parametrize(
    ("keys", "shown"),
    [
        (["f6"], "log"), (["ctrl+g", "6"], "log"), (["ctrl+g", "f6"], "log"), (["f6", "ctrl+g", "1"], "drive"),
        (["f6", "ctrl+g", "ctrl+g"], "drive"), (["f6", "escape", "ctrl+g", "ctrl+g"], "log"),
        (["right_square_bracket"], TABS[1]), (["left_square_bracket"], TABS[-1]), (["f4"], "params"),
        (["f6", "right_square_bracket"], (TABS + TABS)[TABS.index("log") + 1]), (["ctrl+g", "7"], "links"),
        (["f6", "left_square_bracket"], TABS[TABS.index("log") - 1]),
        (["f7", "right_square_bracket"], TABS[TABS.index("links") + 1]),
        (["ctrl+g", "escape"], "drive"), (["ctrl+g", "x"], "drive"),
        (["f6", "ctrl+g", "escape"], "log"), (["f6", "f6"], "log"), (["question_mark", "f6"], "log"),
        (["f6", "question_mark", "escape"], "drive"),
    ],
)  # fmt: skip
async def test_ways_between_the_screens(keys: list[str], shown: str) -> None:
    async with console() as screen:
        await screen.press(*keys)
        kind = load_screen(next(row for row in SCREENS if row.id == shown))
        await until(lambda: isinstance(screen.app.screen, kind))
        assert len(screen.app.screen_stack) == (2 if shown == "drive" else 3)
        await until(lambda: (screen.app.gate.closure is None) is (shown == "drive"))


async def test_the_menu_commands_nothing_but_the_next_vehicle() -> None:
    """Outside of the menu the digits are modes."""
    async with console() as screen:
        for key in ("1", "2", "6", "r", "g"):
            await screen.press("ctrl+g", key)
            await screen.press("f1")
        await screen.press("ctrl+g", "n")
        await until(lambda: screen.app.screen is screen.app.drive)
        assert screen.station.of(SelectNextVehicle) == [SelectNextVehicle()]
        assert not screen.station.of(SetMode)
        assert not screen.station.of(Disarm)
        assert not screen.station.of(RequestControl)


async def test_stops_work_in_the_menu() -> None:
    async with console() as screen:
        await screen.press("ctrl+g")
        before = len(screen.station.of(Stop))
        await screen.press("space")
        assert len(screen.station.of(Stop)) == before + 1
        await screen.press("ctrl+g", "exclamation_mark")
        assert screen.station.of(EmergencyStop)


async def test_drive_keys_drive_on_drive_only_and_stops_stop_everywhere() -> None:
    async with console() as screen:
        open_extra(screen)
        await screen.pilot.pause()
        await screen.press("i", "space", "exclamation_mark")
        assert screen.station.of(SetKeyGate)[-1].open is False  # the station rejects the drive key
        assert screen.station.of(DriveKeyDown)
        assert screen.station.of(Stop)
        assert screen.station.of(EmergencyStop)
