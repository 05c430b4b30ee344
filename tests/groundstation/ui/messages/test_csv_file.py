"""A CSV file of one message: begun, written, ended, full; a disk that takes no more."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from groundstation.ui.messages import csv_file
from groundstation.ui.messages.calls import NEVER, parse_rate
from groundstation.ui.messages.csv_file import MessageCsv
from groundstation.views.messages import CapturePage, CaptureRequest, MessageRequest

MESSAGE = MessageRequest(1, 1, False, "SYS_STATUS")


def page(after: int, *lines: str, lost: int = 0) -> CapturePage:
    return CapturePage("time,load", lines, after + len(lines), after, lost)


def only_file(folder: Path) -> str:
    [name] = os.listdir(folder)
    return (folder / name).read_text("utf-8")


def test_each_line_is_written_once_and_the_titles_come_first(tmp_path: Path) -> None:
    csv = MessageCsv(tmp_path)
    assert csv.request is None
    assert "writing SYS_STATUS to" in csv.toggle(MESSAGE)
    assert csv.request == CaptureRequest(1, 1, False, "SYS_STATUS", 0)
    assert csv.add(page(0, "1,2", "2,3")) is None
    assert csv.add(page(0, "1,2", "2,3")) is None
    assert csv.request == CaptureRequest(1, 1, False, "SYS_STATUS", 2)
    csv.add(page(2, "3,4", lost=7))
    assert csv.status.startswith("3 rows to SYS_STATUS-1-1-")
    ended = csv.toggle(MESSAGE)
    assert "3 rows in" in ended
    assert "7 messages were too many" in ended
    assert only_file(tmp_path) == "time,load\n1,2\n2,3\n3,4\n"
    assert (csv.request, csv.status) == (None, "")


def test_a_file_has_a_bound(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(csv_file, "MAX_SIZE", 20)
    csv = MessageCsv(tmp_path)
    csv.toggle(MESSAGE)
    assert "file is full: 2 rows" in (csv.add(page(0, "1,2345", "2,3456")) or "")
    assert csv.add(page(2, "3,4")) is None
    assert csv.request is None


def test_a_full_disk_is_said_once_and_ends_the_file(tmp_path: Path) -> None:
    (tmp_path / "full").symlink_to("/dev/full")
    csv = MessageCsv(tmp_path)
    csv.toggle(MESSAGE)
    assert csv._file is not None
    csv._file.close()
    csv._file = (tmp_path / "full").open("w", encoding="utf-8")  # a device that takes nothing, as a full disk
    said = csv.add(page(0, "1,2"))
    assert "No space left on device" in (said or "")
    assert csv.add(page(0, "1,2")) is None
    assert csv.close() == ""


def test_a_folder_that_is_not_there_and_nothing_chosen(tmp_path: Path) -> None:
    csv = MessageCsv(tmp_path / "missing")
    assert "not saved: No such file or directory" in csv.toggle(MESSAGE)
    assert "choose a message" in csv.toggle(None)
    assert "no fields to save" in csv.toggle(MessageRequest(1, 1, False, "#51000"))


@pytest.mark.parametrize(
    ("text", "rate"),
    [("5", 5.0), ("0.5 Hz", 0.5), ("0", 0.0), ("default", 0.0), ("OFF", NEVER), ("", None), ("-1", None), ("1e9", None),
     ("nan", None), ("fast", None)],
)  # fmt: skip
def test_rates_that_people_type(text: str, rate: float | None) -> None:
    assert parse_rate(text) == rate
