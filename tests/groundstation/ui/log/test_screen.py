"""The Log screen: alerts, scrolling, filter, saving."""

from __future__ import annotations

from pathlib import Path

import pytest

from groundstation.intents.driving import DriveKeyDown, EmergencyStop, Stop
from groundstation.intents.session import SetKeyGate
from groundstation.intents.watch import Watch
from groundstation.snapshot import LogLine
from groundstation.ui.base.local_files import short_path
from groundstation.ui.base.screen import ConsoleScreen
from groundstation.ui.keys.key_gate import OTHER_SCREEN, TEXT_FIELD
from groundstation.ui.log.screen import LogScreen
from groundstation.views.log import LogPage, LogRequest
from groundstation.views.requests import RequestsRequest
from tests.groundstation.ui.examples import DRIVE_WATCH, LOG_PAGE, NOON, snapshot, vehicle
from tests.groundstation.ui.pilots import Console, console
from tests.waits import until

MANY = LogPage(
    tuple(LogLine(time=NOON, severity=6, label="vehicle", text=f"line {n}.", number=n) for n in range(1, 101)), 100
)
SETTINGS = tuple(f"SETTING_{number} 0: the rover never stops when the link is lost" for number in range(12))
WARNED = snapshot(vehicle=vehicle(warnings=SETTINGS, refusal="mode AUTO denied: no mission"))


async def open_log(screen: Console, page: LogPage = MANY) -> LogScreen:
    await screen.press("f6")
    await until(lambda: Watch((LogRequest(0), RequestsRequest())) in screen.station.of(Watch))
    screen.station.offer_view(page)
    await screen.show(snapshot())
    top = screen.app.screen
    assert isinstance(top, LogScreen)
    return top


async def test_it_requests_lines_while_open_and_says_which_it_has() -> None:
    async with console() as screen:
        await open_log(screen)
        await until(lambda: screen.station.of(Watch)[-1] == Watch((LogRequest(100), RequestsRequest())))
        assert Watch((LogRequest(0), RequestsRequest())) in screen.station.of(Watch)
        await screen.press("escape")
        await until(lambda: screen.station.of(Watch)[-1] == DRIVE_WATCH)


async def test_under_the_menu_it_stays_live() -> None:
    async with console() as screen:
        await open_log(screen)
        await screen.press("ctrl+g")
        await until(lambda: screen.station.of(Watch)[-1] == Watch((LogRequest(100), RequestsRequest())))
        line = LogLine(time=NOON, severity=6, label="vehicle", text="under the menu", number=101)
        screen.station.offer_view(LogPage((line,), 101, after=100))
        await screen.show(snapshot(vehicle=vehicle(mode="HOLD")))
        await until(lambda: "under the menu" in screen.text and " HOLD  ARMED " in screen.text)
        assert "go to" in screen.text


def marked(screen: Console) -> str:
    """Return the row with the cursor, without the frames."""
    (row,) = (row for row in screen.text.splitlines() if row.startswith("│›"))
    return row[2:].split("│")[0].rstrip()


@pytest.mark.parametrize("size", [(80, 24), (140, 45), (60, 15)])
async def test_arrows_and_pages_scroll(size: tuple[int, int]) -> None:
    async with console(size) as screen:
        await open_log(screen)
        assert "line 100." in screen.text
        await screen.press("home")
        await until(lambda: "line 1." in screen.text)
        assert "line 100." not in screen.text
        await until(lambda: "END follows the newest line" in screen.text)
        assert marked(screen).endswith(" line 1.")
        await screen.press("down")
        await until(lambda: marked(screen).endswith(" line 2."))
        await screen.press("up", "pagedown", "pagedown")
        await until(lambda: "line 1." not in screen.text)
        await screen.press("pageup", "pageup")
        await until(lambda: marked(screen).endswith(" line 1."))
        await screen.press("end")
        await until(lambda: "line 100." in screen.text and "live, newest below" in screen.text)


async def test_all_alerts_are_listed_whole_and_scroll_where_many() -> None:
    async with console(picture=WARNED) as screen:
        assert "+12 F6" in screen.text
        await open_log(screen)
        await screen.show(WARNED)
        await screen.show(WARNED)
        assert "mode AUTO denied: no mission" in screen.text
        for text in SETTINGS[:9]:
            assert text in screen.text
        assert SETTINGS[11] not in screen.text
        assert "13 rows · TAB, then ↑ ↓" in screen.text
        await screen.press("tab", "end")
        await until(lambda: SETTINGS[11] in screen.text)
        await screen.press("tab", "home")
        await until(lambda: "END follows the newest line" in screen.text)
        assert SETTINGS[11] in screen.text


async def test_a_long_alert_is_wrapped_not_cut() -> None:
    text = "FS_THR_ENABLE 0: without an RC receiver never stops when the link is lost"
    async with console((50, 20), snapshot(vehicle=vehicle(warnings=(text,)))) as screen:
        await screen.press("f6")
        await until(lambda: "receiver never│" in screen.text and "  stops when the link is lost " in screen.text)


async def test_warnings_and_all() -> None:
    async with console() as screen:
        await open_log(screen, LOG_PAGE)
        await until(lambda: "arm accepted" in screen.text)
        await screen.press("w")
        await until(lambda: "arm accepted" not in screen.text)
        assert "battery 11.9 V" in screen.text
        assert "3 of 8 lines" in screen.text
        await screen.press("a")
        await until(lambda: "arm accepted" in screen.text)


async def test_typing_filters_enter_keeps_text_and_escape_clears_it() -> None:
    async with console() as screen:
        top = await open_log(screen, LOG_PAGE)
        await screen.press("slash", *"k", "backspace", *"regain")
        await until(lambda: "1 of 8 lines" in screen.text)
        assert screen.app.screen is top
        assert "^k Stop" in screen.text
        await screen.press("enter")
        await until(lambda: "with “regain”" in screen.text)
        await screen.press("slash", "escape")
        await until(lambda: "arm accepted" in screen.text)
        assert screen.app.screen is top
        await screen.press("escape")
        await until(lambda: screen.app.screen is screen.app.drive)


async def test_a_letter_in_the_text_is_no_stop_and_stops_still_work() -> None:
    async with console() as screen:
        await open_log(screen)
        assert (shut := screen.app.gate.closure) is not None
        assert shut.reason == OTHER_SCREEN.reason
        await screen.press("slash")
        await until(lambda: screen.app.gate.closure == TEXT_FIELD)
        before = len(screen.station.of(Stop))
        await screen.press("k", "space", "s", "i")
        assert len(screen.station.of(Stop)) == before
        await screen.press("ctrl+k")
        assert len(screen.station.of(Stop)) == before + 1
        assert not screen.station.of(EmergencyStop)
        await screen.press("exclamation_mark")
        assert screen.station.of(EmergencyStop)


async def test_nothing_drives_there_and_both_stops_work() -> None:
    async with console() as screen:
        await open_log(screen)
        await screen.press("i", "up")
        assert screen.station.of(SetKeyGate)[-1].open is False
        assert screen.station.of(DriveKeyDown)
        for key in ("space", "k"):
            before = len(screen.station.of(Stop))
            await screen.press(key)
            assert len(screen.station.of(Stop)) == before + 1
        await screen.press("f9")
        assert screen.station.of(EmergencyStop)


def saved_lines(folder: Path) -> list[str]:
    (file,) = folder.iterdir()
    return file.read_text("utf-8").splitlines()


async def test_saving_writes_what_is_shown(tmp_path: Path) -> None:
    async with console(folder=tmp_path) as screen:
        await open_log(screen, LOG_PAGE)
        await screen.press("w", "S")
        await until(lambda: "saved 3 lines to" in screen.text)
    lines = saved_lines(tmp_path)
    assert [line.split()[1] for line in lines] == ["WARN", "WARN", "CRIT"]
    assert lines[1] == "2023-11-14T22:13:40.0+0000 WARN  battery 11.9 V below 12.0 V  ×3"


async def test_a_folder_that_cannot_be_written_is_named(tmp_path: Path) -> None:
    async with console((140, 45), folder=tmp_path / "missing") as screen:
        await open_log(screen, LOG_PAGE)
        await screen.press("S")
        await until(lambda: "not saved: No such file or directory: " in screen.text)


def test_the_home_folder_is_shortened(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HOME", "/home/you")
    assert short_path(Path("/home/you/logs/a.txt")) == "~/logs/a.txt"
    assert short_path(Path("/var/a.txt")) == "/var/a.txt"


async def test_y_copies_the_marked_message() -> None:
    async with console() as screen:
        await open_log(screen)
        await screen.press("up", "y")
        assert screen.app.clipboard == "line 99."
        assert "copied line 99." in screen.text


@pytest.mark.parametrize("key", ["f6", "f3", "f4", "question_mark"])
async def test_escape_clears_a_kept_filter_before_it_leaves(key: str) -> None:
    async with console((100, 30)) as screen:
        await screen.press(key, "slash", *"volt", "enter")
        top = screen.app.screen
        assert isinstance(top, ConsoleScreen)
        assert top.kept_filter == "volt"
        await screen.press("escape")
        assert top.is_current
        assert not top.kept_filter
        await screen.press("escape")
        await until(lambda: screen.app.screen is screen.app.drive)
