"""Opening screens of the table and going back."""

from __future__ import annotations

import math

import pytest

from groundstation.actions import ACTIONS
from groundstation.intents.driving import DriveKeyDown, EmergencyStop, Stop
from groundstation.intents.session import SetKeyGate
from groundstation.intents.vehicle import Disarm, RequestControl, SelectNextVehicle, SetMode
from groundstation.screens import SCREENS, ScreenRow
from groundstation.ui.app.help import HelpScreen
from groundstation.ui.app.navigation import ROOT, load_screen
from groundstation.ui.base.screen import ConsoleScreen
from groundstation.ui.drive.instruments.heading_tape import HeadingTape
from groundstation.ui.drive.screen import DriveScreen
from groundstation.ui.keys.key_gate import OTHER_SCREEN
from groundstation.ui.log.screen import LogScreen
from groundstation.ui.widgets.status import StatusBar
from tests.groundstation.ui.examples import snapshot, vehicle
from tests.groundstation.ui.extra_screen import ExtraScreen
from tests.groundstation.ui.pilots import Console, console, type_in
from tests.waits import until

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
async def test_a_screen_without_keys_is_left_by_escape_or_drives_key(key: str) -> None:
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


WAYS: list[tuple[list[str], str]] = [
    (["f6"], "log"), (["ctrl+g", "6"], "log"), (["ctrl+g", "f6"], "log"), (["f6", "ctrl+g", "1"], "drive"),
    (["f6", "ctrl+g", "ctrl+g"], "drive"), (["f6", "escape", "ctrl+g", "ctrl+g"], "log"),
    (["right_square_bracket"], TABS[1]), (["left_square_bracket"], TABS[-1]), (["f4"], "params"),
    (["f6", "right_square_bracket"], (TABS + TABS)[TABS.index("log") + 1]), (["ctrl+g", "7"], "links"),
    (["f6", "left_square_bracket"], TABS[TABS.index("log") - 1]),
    (["f7", "right_square_bracket"], TABS[TABS.index("links") + 1]),
    (["ctrl+g", "escape"], "drive"), (["ctrl+g", "x"], "drive"),
    (["f6", "ctrl+g", "escape"], "log"), (["f6", "f6"], "log"), (["question_mark", "f6"], "log"),
    (["f6", "question_mark", "escape"], "log"),
]  # fmt: skip
"""Keys that are pressed on Drive, and the screen that is open then."""


async def test_ways_between_the_screens() -> None:
    async with console() as screen:
        for keys, shown in WAYS:
            await go(screen, keys, shown)
            await screen.go_home()
            await until(lambda: screen.app.gate.closure is None)


async def go(screen: Console, keys: list[str], shown: str) -> None:
    """Press keys and check which screen is open then."""
    await screen.press(*keys)
    kind = load_screen(next(row for row in SCREENS if row.id == shown))
    await until(lambda: isinstance(screen.app.screen, kind))
    assert len(screen.app.screen_stack) == (2 if shown == "drive" else 3), (keys, shown)
    await until(lambda: (screen.app.gate.closure is None) is (shown == "drive"))


async def test_the_key_of_the_menu_and_a_digit_in_one_read() -> None:
    """A fast typist over SSH. On Drive and Map the digits are modes, on Setup motors."""
    async with console() as screen:
        for row in (
            *(row for row in SCREENS if row.in_tabs and row is not ROOT),
            ROOT,
        ):  # each is another one than before
            type_in(screen, f"\x07{row.digit}")
            kind = load_screen(row)
            await until(lambda kind=kind: isinstance(screen.app.screen, kind))  # type: ignore[misc]
            await screen.pilot.pause()
            assert isinstance(screen.app.screen, ConsoleScreen)
            assert screen.app.screen.question is None
        assert not screen.station.of(SetMode)


async def test_the_menu_key_twice_in_one_read_opens_the_screen_before() -> None:
    async with console() as screen:
        await screen.press("f6", "f1")
        type_in(screen, "\x07\x07")
        await until(lambda: isinstance(screen.app.screen, LogScreen))


@pytest.mark.parametrize("data", ["\x07x3", "\x1b\x073i", "3\x07\x1b[A"], ids=repr)
async def test_other_keys_in_one_read_with_the_menu_key_do_nothing(data: str) -> None:
    async with console() as screen:
        screen.station.intents.clear()
        type_in(screen, data)
        assert screen.station.intents[0] == SetKeyGate(open=False, reason=OTHER_SCREEN.reason)
        await screen.pilot.pause()
        assert not screen.station.of(SetMode)


async def test_the_menu_ends_a_question() -> None:
    """Else its answer would still count when the screen is back."""
    async with console() as screen:
        await screen.press("f8")
        performed: list[str] = []
        shown = screen.app.screen
        assert isinstance(shown, ConsoleScreen)
        shown.ask("restart the vehicle", lambda: performed.append("restarted"))
        await screen.press("ctrl+g", "escape", "y")
        assert not performed


async def test_in_a_text_field_the_key_of_the_menu_opens_nothing() -> None:
    async with console() as screen:
        await screen.press("f6", "slash")
        type_in(screen, "\x073")
        shown = screen.app.screen
        assert isinstance(shown, LogScreen)
        await until(lambda: shown.field.value == "3")


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


async def test_drive_keys_work_on_drive_only_and_stops_everywhere() -> None:
    async with console() as screen:
        open_extra(screen)
        await screen.pilot.pause()
        await screen.press("i", "space", "exclamation_mark")
        assert screen.station.of(SetKeyGate)[-1].open is False  # the station rejects the drive key
        assert screen.station.of(DriveKeyDown)
        assert screen.station.of(Stop)
        assert screen.station.of(EmergencyStop)


async def test_drive_draws_nothing_while_another_screen_hides_it() -> None:
    north, east = snapshot(vehicle=vehicle(heading=0.0)), snapshot(vehicle=vehicle(heading=math.pi / 2))
    async with console(picture=north) as screen:
        tape = screen.app.drive.query_one(HeadingTape)
        await screen.press("ctrl+g")
        await screen.show(east)  # the menu covers a part of Drive only
        assert tape.value == 90
        await screen.press("6")
        await screen.show(north)
        assert tape.value == 90
        await screen.press("f1")
        await until(lambda: tape.value == 0)
