"""`y` copies what is under the cursor, on every screen with a list."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from groundstation.screens import SCREENS
from groundstation.ui.app.navigation import load_screen
from groundstation.ui.base.screen import ConsoleScreen
from groundstation.views.base import View
from tests.groundstation.ui import example_connect, example_files, example_params, example_setup, link_examples
from tests.groundstation.ui.example_charts import CHART_VIEWS
from tests.groundstation.ui.examples import LOG_PAGE, MESSAGES_PAGE, SYS_STATUS_VIEW, snapshot
from tests.groundstation.ui.files.test_log_summary import HEARTBEATS, log
from tests.groundstation.ui.pilots import Console, console
from tests.waits import until

Keys = tuple[str, ...]
SIZE = (80, 24)

CASES: list[tuple[str, Sequence[View], Keys, str]] = [
    ("messages", (MESSAGES_PAGE, SYS_STATUS_VIEW), (), "SYS_STATUS"),
    ("messages", (MESSAGES_PAGE, SYS_STATUS_VIEW), ("tab",), "SYS_STATUS."),
    ("params", (example_params.PAGE,), (), " "),
    ("log", (LOG_PAGE,), (), ""),
    ("charts", CHART_VIEWS, (), "VFR_HUD.groundspeed"),
    ("links", link_examples.VIEWS, (), ", system id "),
    ("links", link_examples.VIEWS, ("tab",), "udpin:"),
    ("setup", (example_setup.doctor_view(),), (), ": "),
    ("files", (example_files.FILES, example_files.NO_TASKS), (), "1-"),
    ("files", (example_files.FILES, example_files.NO_TASKS), ("tab",), "/"),
    ("files", (example_files.FILES, example_files.TASKS), ("tab", "tab", "tab"), " "),
    ("replay", (), (), "a.tlog"),
    ("connect", (example_connect.CONNECT,), (), ":"),
]
"""Screen, views, keys before `y`, and a part of what is copied then."""


async def open_screen(screen: Console, name: str, views: Sequence[View]) -> ConsoleScreen:
    row = next(each for each in SCREENS if each.id == name)
    screen.app._navigator.open(row)
    await until(lambda: isinstance(screen.app.screen, load_screen(row)))
    await screen.pilot.pause()
    top = screen.app.screen
    assert isinstance(top, ConsoleScreen)
    for view in views:
        top.show_view(view)
    await screen.pilot.pause()
    return top


async def test_y_copies_what_is_under_the_cursor(tmp_path: Path) -> None:
    (tmp_path / "a.tlog").write_bytes(log(HEARTBEATS, 60.0))
    async with console(folder=tmp_path) as screen:
        for name, views, keys, part in CASES:
            await screen.begin_anew(SIZE, snapshot())
            screen.app.copy_to_clipboard("")
            top = await open_screen(screen, name, views)
            if name == "messages":
                await screen.press(*["down"] * 8)
                for view in views:
                    top.show_view(view)
            await screen.press(*keys, "y")
            copied = screen.app.clipboard
            assert copied, name
            assert part in copied, name
            assert "copied" in top.hint, name


async def test_y_with_nothing_under_the_cursor_copies_nothing(tmp_path: Path) -> None:
    async with console(folder=tmp_path) as screen:
        top = await open_screen(screen, "replay", ())
        await screen.press("y")
        assert screen.app.clipboard == ""
        assert "no telemetry log in" in top.hint
        assert "ENTER Open" in screen.text
        assert "p Play" not in screen.text
