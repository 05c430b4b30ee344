"""Exports beside the screens: real processes that write files, and leave nothing when they are stopped."""

from __future__ import annotations

import asyncio
from pathlib import Path

import pytest

from groundstation.export.log_time import parse_log_time
from groundstation.replay.log_replay import LogReplay
from groundstation.ui.files.exports import ExportRequest, Exports, parse_request
from groundstation.ui.replay.model import part_text
from groundstation.ui.widgets.line_field import LineField
from groundstation.views.replay import ReplayView
from groundstation.views.requests import RequestLine
from link.tlog.tlog import read_records
from tests.groundstation.export.logs import drive
from tests.groundstation.held_key import hold_until
from tests.groundstation.replay.logs import NOON, BytesSource, build_station, drive_log, finish
from tests.groundstation.ui.files.test_screen import WIDE, open_files
from tests.groundstation.ui.pilots import console
from tests.groundstation.ui.replay_station import replay_console
from tests.waits import until

FOLDER = Path("/logs")
LOG = FOLDER / "a.tlog"


@pytest.fixture
def log(tmp_path: Path) -> Path:
    (tmp_path / "a.tlog").write_bytes(drive())
    return tmp_path / "a.tlog"


@pytest.mark.parametrize(
    ("text", "format_", "output", "begin", "end"),
    [
        ("a.mcap", "mcap", "a.mcap", "", ""),
        ("my drive.gpx 0:31", "gpx", "my drive.gpx", "0:31", ""),
        (" part.tlog  0:31 +44 ", "tlog", "part.tlog", "0:31", "+44"),
        ("tables/ 12:04:10 12:05:00", "csv", "tables", "12:04:10", "12:05:00"),
        ("/tmp/x.kml", "kml", "/tmp/x.kml", "", ""),
    ],
)
def test_a_name_chooses_the_format(text: str, format_: str, output: str, begin: str, end: str) -> None:
    assert parse_request(text, LOG, FOLDER) == ExportRequest(LOG, FOLDER / output, format_, begin, end)


@pytest.mark.parametrize("text", ["", "a", "a.csv", "a.mcap 1 2 3", "a.png"])
def test_another_name_is_none(text: str) -> None:
    assert parse_request(text, LOG, FOLDER) is None


async def ended(exports: Exports, number: int) -> RequestLine:
    def find() -> list[RequestLine]:
        return [line for line in exports.lines if line.number == number and line.state != "running"]

    return (await until(find))[0]


async def test_an_export_ends_as_a_request_does(log: Path) -> None:
    exports = Exports()
    exports.start(1, ExportRequest(log, log.with_name("a.jsonl"), "jsonl", "0:00", "0:01"))
    exports.start(2, ExportRequest(log, log.with_name("b.jsonl"), "jsonl", "soon"))
    exports.start(3, ExportRequest(log, log.with_name("c.jsonl"), "jsonl"))
    assert [line.state for line in exports.lines] == ["running"] * 3
    assert exports.cancel(3)
    done, refused, stopped = [await ended(exports, number) for number in (1, 2, 3)]
    assert (done.state, done.what, done.detail) == ("accepted", "export a.jsonl", "72 messages")
    assert (refused.state, "'soon' is not a time in a log" in refused.detail) == ("refused", True)
    assert (stopped.state, stopped.detail) == ("cancelled", "nothing is written")
    assert not exports.cancel(1)
    assert {each.name for each in log.parent.iterdir()} == {"a.tlog", "a.jsonl"}


async def test_files_exports_the_log_under_the_cursor(log: Path) -> None:
    async with console(WIDE, folder=log.parent) as screen:
        await open_files(screen)
        await screen.press("E", "enter")
        await until(lambda: (log.parent / "a.mcap").exists())
        await hold_until(lambda: screen.press("R"), lambda: "accepted" in screen.text)
        (row,) = (line for line in screen.text.splitlines() if "export a.mcap" in line)
        assert "✓" in row
        await screen.press("tab", "tab", "down", "E", "enter")  # the newest file is the first
        await until(lambda: "a.mcap is here already and would be replaced" in screen.text)
        await screen.press("escape")
        await screen.press("E")
        await screen.press("backspace", "enter")
        await until(lambda: "name it name.mcap" in screen.text)


async def test_end_of_the_program_ends_an_export_without_half_a_file(log: Path) -> None:
    exports = Exports()
    exports.start(1, ExportRequest(log, log.with_name("a.mcap"), "mcap"))
    await until(lambda: exports._processes)
    process, task = exports._processes[1], exports._tasks[1]
    task.cancel()  # as asyncio.run() does at the end
    await asyncio.wait([task])
    assert process.returncode is not None
    assert {each.name for each in log.parent.iterdir()} == {"a.tlog"}


async def test_replay_exports_the_part_between_the_marks(tmp_path: Path) -> None:
    log = tmp_path / "logs" / "drive.tlog"
    log.parent.mkdir()
    log.write_bytes(bytes(drive_log().data))
    desk = LogReplay(str(log), BytesSource(log.read_bytes()), build_station, at="35")
    finish(desk)
    async with replay_console(desk, WIDE, folder=tmp_path) as screen:
        await screen.press("m", "shift+right", "m")
        await screen.press("E")
        assert screen.app.screen.query_one(LineField).value == "drive.mcap 0:35 0:45"
        await screen.pilot.press(*["backspace"] * len("mcap 0:35 0:45"), *"tlog 0:35.5 0:45", "enter")
        await until(lambda: (tmp_path / "drive.tlog").exists())
        for _ in range(50):
            if "export drive.tlog: accepted" in screen.text:
                break
            await screen.show(times=1)
        assert "export drive.tlog: accepted" in screen.text
    first, *_, last = read_records((tmp_path / "drive.tlog").read_bytes())
    assert (first.microseconds, last.microseconds) == (round((NOON + 35.5) * 1e6), round((NOON + 44.9) * 1e6))


@pytest.mark.parametrize(
    ("cut", "text"),
    [
        ((None, None), ""),
        ((0.0, None), "0:00"),
        ((31.57, 3725.000001), "0:31.57 62:05.000001"),
        ((59.9999999, 60.0), "1:00 1:00"),
    ],
)
def test_marks_are_written_as_exports_take_them(cut: tuple[float | None, float | None], text: str) -> None:
    shown = part_text(ReplayView(cut=cut))
    assert shown == text
    times = [parse_log_time(each).microseconds for each in shown.split()]
    assert times == [round(each * 1e6) for each in cut if each is not None]
