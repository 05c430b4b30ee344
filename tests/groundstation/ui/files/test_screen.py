"""The Files screen: what it requests, questions before anything is lost, tasks that go on elsewhere."""

from __future__ import annotations

from pathlib import Path

import msgspec

from groundstation.intents.files import (
    CompareFile,
    EraseLogs,
    GetFile,
    GetLog,
    ListFolder,
    ListLogs,
    PutFile,
    RemoveFile,
)
from groundstation.intents.services import CancelRequest
from groundstation.intents.watch import Watch
from groundstation.snapshot import RecordingView
from groundstation.ui.display.task_list import TaskList
from groundstation.views.base import View
from groundstation.views.files import FileRow, FilesRequest, FilesView, FolderRow
from groundstation.views.requests import RequestLine, RequestsRequest, RequestsView
from tests.groundstation.ui.example_files import FILES, FOLDERS, NO_TASKS, TASKS, fill_folder
from tests.groundstation.ui.examples import snapshot
from tests.groundstation.ui.files.test_log_summary import HEARTBEATS, log
from tests.groundstation.ui.pilots import Console, console
from tests.waits import until

WIDE = (140, 45)


async def offer(screen: Console, *views: View) -> None:
    for view in views:
        screen.station.offer_view(view)
    await screen.show(snapshot())
    await screen.show(snapshot())


async def open_files(screen: Console, view: FilesView = FILES, tasks: RequestsView = NO_TASKS) -> None:
    await screen.press("ctrl+g", "9")
    await until(lambda: screen.station.of(Watch))
    await offer(screen, view, tasks)


async def test_it_lists_the_logs_and_top_folder_of_each_vehicle_once() -> None:
    async with console(WIDE) as screen:
        await open_files(screen)
        assert screen.station.of(Watch)[-1] == Watch((FilesRequest(("/",)), RequestsRequest()))
        assert [each.system for each in screen.station.of(ListLogs)] == [1]
        assert [each.path for each in screen.station.of(ListFolder)] == ["/"]
        await offer(screen, FILES, NO_TASKS)
        await screen.press("escape", "ctrl+g", "9")
        await offer(screen, FILES)
        assert len(screen.station.of(ListLogs)) == 1
        await offer(screen, msgspec.structs.replace(FILES, system=2, name="Rover 2"))
        assert [each.system for each in screen.station.of(ListLogs)] == [1, 2]
        await screen.press("R")
        assert len(screen.station.of(ListLogs)) == 3


async def test_log_is_downloaded_and_a_present_one_only_after_the_word(tmp_path: Path) -> None:
    async with console(WIDE, folder=fill_folder(tmp_path)) as screen:
        await open_files(screen)
        await screen.press("D")
        (get,) = screen.station.of(GetLog)
        assert (get.log, get.folder, get.name, get.overwrite) == (14, str(tmp_path), "1-00014.bin", False)
        await screen.press("down", "D")
        assert "1-00013.bin is here already and would be replaced · type overwrite" in screen.text
        await screen.press("y")
        assert len(screen.station.of(GetLog)) == 1
        await screen.press("D", *"overwrite")
        assert [(each.log, each.overwrite) for each in screen.station.of(GetLog)] == [(14, False), (13, True)]


async def test_the_tree_opens_folder_by_folder_and_its_files_come_down() -> None:
    async with console(WIDE) as screen:
        await open_files(screen)
        await screen.press("tab", "down", "enter")
        assert screen.station.of(ListFolder)[-1].path == "/APM"
        await until(lambda: screen.station.of(Watch)[-1] == Watch((FilesRequest(("/", "/APM")), RequestsRequest())))
        await screen.press("D")
        assert "choose a log or a file of the vehicle first" in screen.text
        await screen.press("down", "enter", "down", "down", "D")
        (get,) = screen.station.of(GetFile)
        assert (get.path, get.name, get.system) == ("/APM/LOGS/00000014.BIN", "00000014.BIN", 1)
        await screen.press("home", "down", "enter")
        assert "00000014.BIN" not in screen.text
        assert len(screen.station.of(ListFolder)) == 3, "closing a folder requests nothing"


async def test_nothing_is_deleted_or_erased_before_a_word_is_typed() -> None:
    async with console(WIDE) as screen:
        await open_files(screen)
        await screen.press("X")
        assert "erase 6 logs on Rover 1, which cannot be undone · type erase" in screen.text
        await screen.press(*"eras", "x", "X", *"erase")
        assert len(screen.station.of(EraseLogs)) == 1
        await screen.press("tab", "X")
        assert "choose a file first" in screen.text
        await screen.press("end", "X")
        assert "delete /crash_dump.bin on Rover 1, which cannot be undone · type delete" in screen.text
        await screen.press("y", "X", *"delete")
        (remove,) = screen.station.of(RemoveFile)
        assert remove.path == "/crash_dump.bin"
        before = len(screen.station.of(ListFolder))
        line = RequestLine(remove.request, "accepted", "remove /crash_dump.bin", service="files", system=1)
        await offer(screen, RequestsView((), (line,)))
        assert [each.path for each in screen.station.of(ListFolder)[before:]] == ["/"]


async def test_file_is_uploaded_to_the_marked_folder_after_a_question(tmp_path: Path) -> None:
    async with console(WIDE, folder=fill_folder(tmp_path)) as screen:
        await open_files(screen)
        await screen.press("tab", "down", "enter", "U", "enter")
        await until(lambda: "upload 1-00013.bin, 14.2 kB, into /APM of Rover 1" in screen.text)
        await screen.press("y")
        (put,) = screen.station.of(PutFile)
        assert (put.path, put.file) == ("/APM/1-00013.bin", str(tmp_path / "1-00013.bin"))
        await screen.press("U", *["backspace"] * 3, "enter")
        await until(lambda: "is not a file of this machine" in screen.text)
        assert len(screen.station.of(PutFile)) == 1


async def test_tasks_are_stopped_here_and_on_the_log_screen() -> None:
    async with console(WIDE) as screen:
        await open_files(screen, tasks=TASKS)
        await screen.press("tab", "tab", "tab", "down", "x")
        assert screen.station.of(CancelRequest) == [CancelRequest(7)]
        await screen.press("end", "x")
        assert len(screen.station.of(CancelRequest)) == 1, "one that has ended cannot be stopped"
        await screen.press("f6")
        await offer(screen, TASKS)
        assert "download log 14" in screen.text
        await screen.press("x")
        assert screen.station.of(CancelRequest)[-1] == CancelRequest(8)
        await offer(screen, NO_TASKS)
        assert "tasks" not in screen.text


async def test_control_characters_of_vehicle_do_not_reach_the_terminal() -> None:
    bad = FolderRow("/", (FileRow("a\x1b[2Jb", 3),))
    async with console(WIDE) as screen:
        await open_files(screen, msgspec.structs.replace(FILES, folders=(bad, *FOLDERS[1:])))
        await screen.press("tab", "end", "X")
        assert "\x1b" not in screen.text
        assert "delete /a�[2Jb" in screen.text


def test_speed_and_time_left_are_those_of_the_last_seconds() -> None:
    tasks = TaskList()
    for second in range(8):
        line = RequestLine(1, "running", "download log 1", done=1000 * (second + 1), total=20_000, service="files")
        tasks.show(RequestsView((line,), ()), float(second))
    speed = tasks.speed(tasks.running[0])
    assert speed is not None
    assert (speed.per_second, speed.left) == (1000.0, 12.0)
    tasks.show(RequestsView((), ()), 9.0)
    assert tasks.speed(line) is None


async def test_a_file_here_is_deleted_after_the_word_unless_it_arrives(tmp_path: Path) -> None:
    async with console(WIDE, folder=fill_folder(tmp_path)) as screen:
        arriving = RequestLine(3, "running", "download log 13", total=14_200, service="files", system=1)
        await open_files(screen, tasks=RequestsView((arriving,), ()))
        await screen.press("tab", "tab", "X")
        assert "1-00013.bin is being downloaded: x stops that first" in screen.text
        await screen.press("end")
        recording = RecordingView(path=str(tmp_path / "threads.txt"), seconds=1.0, size=1100)
        await screen.show(snapshot(recording=recording))
        await screen.press("X")
        assert "threads.txt is the recording of this session" in screen.text
        await screen.show(snapshot())
        await screen.press("X")
        assert "delete threads.txt here, 1.1 kB, which cannot be undone · type delete" in screen.text
        await screen.press("y")
        assert (tmp_path / "threads.txt").exists()
        await screen.press("X", *"delete")
        await until(lambda: "threads.txt is deleted" in screen.text)
        assert not (tmp_path / "threads.txt").exists()
        (tmp_path / "2-00003.bin").unlink()
        await screen.press("end", "X", *"delete")
        await until(lambda: "2-00003.bin: not deleted: No such file or directory" in screen.text)


async def test_a_file_there_is_compared_with_the_one_here(tmp_path: Path) -> None:
    name = "crash_dump.bin"
    async with console(WIDE, folder=fill_folder(tmp_path)) as screen:
        await open_files(screen)
        await screen.press("C")
        assert "choose a file of the vehicle first" in screen.text
        await screen.press("tab", "end", "C")
        (first,) = screen.station.of(CompareFile)
        assert (first.path, first.file) == (f"/{name}", str(tmp_path / "1-00013.bin")), "none here has its name"
        (tmp_path / name).write_bytes(b"x")
        await screen.press("R", "C")
        compare = screen.station.of(CompareFile)[-1]
        assert compare.file == str(tmp_path / name)
        line = RequestLine(compare.request, "accepted", f"compare /{name} with {name}", "differs: CRC 1 there, 2 here",
                           service="files", system=1)  # fmt: skip
        await offer(screen, RequestsView((), (line,)))
        assert "✗ differs: CRC 1 there, 2 here" in screen.text
        (tmp_path / name).write_bytes(b"another")
        await screen.press("R")
        await offer(screen, NO_TASKS)
        assert "differs" not in screen.text, "it is another file now"


async def test_a_telemetry_log_here_shows_its_vehicle_and_its_length(tmp_path: Path) -> None:
    (tmp_path / "drive.tlog").write_bytes(log(HEARTBEATS, seconds=754.0))
    (tmp_path / "broken.tlog").write_bytes(b"no log")
    async with console(WIDE, folder=tmp_path) as screen:
        await open_files(screen)
        await until(lambda: "id 1 7" in screen.text)
        (row,) = (line for line in screen.text.splitlines() if "drive.tlog" in line)
        assert "12:34" in row
