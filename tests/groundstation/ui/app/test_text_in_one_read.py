"""Keys of a text field that come in one read, as slow lines and pasting bring them: each does what it did alone."""

from __future__ import annotations

from pathlib import Path

import pytest

from groundstation.screens import SCREENS
from groundstation.ui.app.command_line import CommandLine
from groundstation.ui.base.screen import ConsoleScreen
from groundstation.ui.drive.screen import DriveScreen
from groundstation.ui.keys.key_gate import TEXT_FIELD
from groundstation.ui.log.screen import LogScreen
from groundstation.ui.messages.screen import MessagesScreen
from tests.groundstation.ui.examples import snapshot
from tests.groundstation.ui.files.test_log_summary import HEARTBEATS, log
from tests.groundstation.ui.pilots import Console, console, type_in
from tests.waits import until

ESC, LEFT, END, BACKSPACE = "\x1b[27u", "\x1b[D", "\x1b[F", "\x7f"
"""Escape as the kitty keyboard protocol sends it: alone, whatever follows."""
F1, F6 = "\x1bOP", "\x1b[17~"
EDITS = f"ab{BACKSPACE}c{LEFT}d"
"""Leaves "adc", if each key acts where it stands."""
FILTERED = ("3", "4", "6")
"""Digits of screens with a filter: Messages, Parameters, Log."""


def top(screen: Console) -> ConsoleScreen:
    assert isinstance(screen.app.screen, ConsoleScreen)
    return screen.app.screen


async def open_screen(screen: Console, digit: str) -> ConsoleScreen:
    await screen.press("ctrl+g", digit)
    name = next(row.target.partition(":")[2] for row in SCREENS if row.digit == digit)
    await until(lambda: type(screen.app.screen).__name__ == name)
    await screen.pilot.pause()
    return top(screen)


@pytest.mark.parametrize("opened", [False, True], ids=["with the key that opens it", "in an open field"])
async def test_editing_keys_act_in_their_order(opened: bool) -> None:
    async with console() as screen:
        for digit in FILTERED:
            page = await open_screen(screen, digit)
            if opened:
                await screen.press("slash")
            type_in(screen, EDITS if opened else f"/{EDITS}")
            await screen.pilot.pause()
            assert page.field.value == "adc", page
            await screen.press("escape")


async def test_keys_behind_the_end_of_a_text_are_keys_of_the_screen() -> None:
    async with console() as screen:
        page = await open_screen(screen, "6")
        for typed, left in ((f"/arm\r/{END}ed\r", "armed"), ("/new\r", "new")):
            type_in(screen, typed)
            await screen.pilot.pause()
            assert (page.field.is_open, page.field.value) == (False, left), "what is typed replaces the old text"
        type_in(screen, f"/x{ESC}\x073")
        await until(lambda: isinstance(screen.app.screen, MessagesScreen))


async def test_a_field_closed_and_reopened_takes_the_keys_behind(tmp_path: Path) -> None:
    (tmp_path / "a.tlog").write_bytes(log(HEARTBEATS, 3.0))
    async with console(folder=tmp_path) as screen:
        page = await open_screen(screen, "9")
        await screen.press("tab", "tab", "E")
        assert page.field.value == "a.mcap"
        type_in(screen, f"xy{ESC}E{BACKSPACE}\r")
        await screen.pilot.pause()
        assert not page.field.is_open
        assert "'a.mca': name it" in page.hint


async def test_lines_that_follow_each_other_on_the_command_line() -> None:
    async with console() as screen:
        await screen.press("colon")
        await until(lambda: isinstance(screen.app.screen, CommandLine))
        type_in(screen, f"mapp{BACKSPACE}\r")
        await until(lambda: "map" in type(screen.app.screen).__name__.lower())


@pytest.mark.parametrize("digit", ["1", "6"], ids=["Drive", "Log"])
async def test_a_line_in_one_read_with_its_colon_runs(digit: str) -> None:
    async with console() as screen:
        if digit != "1":
            await open_screen(screen, digit)
        type_in(screen, ":speed")
        await until(lambda: isinstance(screen.app.screen, CommandLine) and screen.app.screen.field.value == "speed")
        await screen.press("escape")
        type_in(screen, ":map\r")
        await until(lambda: "map" in type(screen.app.screen).__name__.lower())


async def test_escape_and_a_key_in_one_read_close_a_field(tmp_path: Path) -> None:
    async with console() as screen:
        page = await open_screen(screen, "6")
        await screen.press("slash", "x")
        screen.app.gate.set_closure(TEXT_FIELD)  # as each tick does
        type_in(screen, "\x1bw")
        await screen.pilot.pause()
        assert not page.field.is_open
        assert "warnings and worse" in page.hint


async def test_a_burst_on_drive_is_named() -> None:
    async with console() as screen:
        await screen.show(snapshot())
        type_in(screen, "speed")
        await until(lambda: "several keys at once: ignored" in screen.text)


@pytest.mark.parametrize(
    ("keys", "shown"), [(F1 * 4, DriveScreen), (f"{F1}{F6}", LogScreen), (f"{F6}{F1}{F1}", DriveScreen)]
)
async def test_function_keys_on_the_command_line_close_it_and_no_more(keys: str, shown: type[ConsoleScreen]) -> None:
    async with console() as screen:
        type_in(screen, ":")
        await until(lambda: isinstance(screen.app.screen, CommandLine))
        type_in(screen, keys)
        await until(lambda: isinstance(screen.app.screen, shown))
        await screen.pilot.pause()
        assert screen.app.drive in screen.app.screen_stack


async def test_text_pasted_behind_the_command_line_closes_nothing() -> None:
    async with console() as screen:
        type_in(screen, ":")
        await until(lambda: isinstance(screen.app.screen, CommandLine))
        type_in(screen, f"{F1}\x1b[200~\r\r\x1b[201~")
        await until(lambda: screen.app.drive.is_current)
        await screen.pilot.pause()
        assert screen.app.drive.is_current
