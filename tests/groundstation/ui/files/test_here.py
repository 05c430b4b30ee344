"""The files of this machine: the one into which the session is recorded."""

from __future__ import annotations

from itertools import count
from pathlib import Path

from groundstation.snapshot import RecordingView
from groundstation.ui.files.model import FilesModel
from groundstation.ui.files.tables import here_value

NAME = "2026-11-22_14-05-09.tlog"


def lines(model: FilesModel) -> list[list[str]]:
    value = here_value(model)
    return [[cell.text for cell in row] for row in value.rows]


def notes(model: FilesModel) -> list[str]:
    return [cell.text for cell in here_value(model).notes]


def test_file_of_this_session_is_marked_with_its_present_size(tmp_path: Path) -> None:
    model = FilesModel(count(1).__next__, tmp_path)
    (tmp_path / "old.tlog").write_bytes(b"x")
    model.disk.scan()
    (tmp_path / NAME).write_bytes(b"")
    for seconds, size in ((1.0, 900), (65.0, 420_000)):
        path = str(tmp_path / NAME)
        model.disk.show_recording(RecordingView(path=path, seconds=seconds, size=size))
    by_name = {line[0]: line for line in lines(model)}
    assert by_name[NAME][2:5] == ["1:05", "", "420.0 kB"]
    assert by_name[NAME][-1] == "● being recorded"
    assert "recorded" not in by_name["old.tlog"][-1]
    assert not any("●" in note for note in notes(model))


def test_a_recording_in_another_folder_is_named(tmp_path: Path) -> None:
    model = FilesModel(count(1).__next__, tmp_path)
    model.disk.show_recording(RecordingView(path="/mnt/logs/" + NAME, seconds=65.0, size=420_000))
    assert notes(model)[-1] == f"● /mnt/logs/{NAME}: 1:05, 420.0 kB"
    model.disk.show_recording(None)
    assert not any("●" in note for note in notes(model))
