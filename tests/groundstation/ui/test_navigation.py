"""Opening screens of the table and going back."""

from __future__ import annotations

import pytest

from groundstation.intents import DriveKeyDown, EmergencyStop, SetKeyGate, Stop
from groundstation.screens import SCREENS, ScreenRow
from groundstation.ui.navigation import ROOT, load_screen
from groundstation.ui.screens.drive import DriveScreen
from groundstation.ui.screens.help import HelpScreen
from groundstation.ui.screens.screen import ConsoleScreen
from tests.groundstation.ui.extra_screen import ExtraScreen
from tests.groundstation.ui.pilots import Console, console
from tests.groundstation.ui.ptys import until

EXTRA = ScreenRow("extra", "Extra", "One more screen", ("f7",), "7", "tests.groundstation.ui.extra_screen:ExtraScreen")
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


async def test_drive_keys_drive_on_drive_only_and_stops_stop_everywhere() -> None:
    async with console() as screen:
        open_extra(screen)
        await screen.pilot.pause()
        await screen.press("i", "space", "exclamation_mark")
        assert screen.station.of(SetKeyGate)[-1].open is False  # the station rejects the drive key
        assert screen.station.of(DriveKeyDown)
        assert screen.station.of(Stop)
        assert screen.station.of(EmergencyStop)
