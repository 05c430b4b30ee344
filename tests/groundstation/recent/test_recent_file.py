"""The file of the endpoints used before, on a real disk: it is private, whole, and never in the way."""

from __future__ import annotations

import os
import stat
import subprocess
import sys
from pathlib import Path

import pytest

from groundstation.recent.recent import RecentEndpoints
from groundstation.recent.recent_file import MAX_SIZE, RecentFile, default_path

A, B = "udpin:127.0.0.1:14550", "serial:/dev/ttyUSB0:57600"


@pytest.fixture
def file(tmp_path: Path) -> RecentFile:
    return RecentFile(tmp_path / "state" / "recent.json")


def test_it_is_in_the_state_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    assert default_path() == tmp_path / "mavhelm" / "recent.json"


def test_no_file_is_an_empty_list_without_a_warning(file: RecentFile) -> None:
    assert file.load() == RecentEndpoints()
    assert file.warning is None


def test_a_change_is_there_for_the_next_program_and_nobody_else(file: RecentFile) -> None:
    file.update(lambda recent: recent.add(A, 1.0, "Rover 1"))
    file.update(lambda recent: recent.add(B, 2.0))
    assert [each.endpoint for each in RecentFile(file.path).load().entries] == [B, A]
    assert stat.S_IMODE(file.path.stat().st_mode) == 0o600
    assert [each.name for each in file.path.parent.iterdir()] == ["recent.json"]


@pytest.mark.parametrize("content", [b"\xff\xfe", b"{", b"[1, 2]"])
def test_a_damaged_file_is_set_aside_with_one_warning(file: RecentFile, content: bytes) -> None:
    file.path.parent.mkdir()
    file.path.write_bytes(content)
    assert file.load() == RecentEndpoints()
    assert file.warning is not None
    assert "damaged" in file.warning
    assert "\n" not in file.warning
    assert file.path.with_name("recent.json.damaged").read_bytes() == content
    assert file.load() == RecentEndpoints()
    assert file.warning is None


def test_a_change_replaces_a_damaged_or_huge_file(file: RecentFile) -> None:
    file.path.parent.mkdir()
    for content in (b"{", b" " * (MAX_SIZE + 1)):
        file.path.write_bytes(content)
        file.update(lambda recent: recent.add(A, 1.0))
        assert file.warning is not None
        assert file.load().last == A
        assert file.warning is None


def test_a_pipe_in_its_place_does_not_block(file: RecentFile) -> None:
    file.path.parent.mkdir()
    os.mkfifo(file.path)
    assert file.load() == RecentEndpoints()
    assert file.warning is not None
    assert "not a regular file" in file.warning


def test_a_folder_that_cannot_be_made_is_a_warning(tmp_path: Path) -> None:
    (tmp_path / "state").write_text("a file")
    file = RecentFile(tmp_path / "state" / "recent.json")
    assert file.update(lambda recent: recent.add(A, 1.0)).last == A
    assert file.warning is not None
    assert "cannot be written" in file.warning


def test_programs_that_change_it_at_the_same_time_lose_nothing(file: RecentFile) -> None:
    script = (
        "import sys; from pathlib import Path; from groundstation.recent.recent_file import RecentFile\n"
        "for port in range(4): RecentFile(Path(sys.argv[1])).update("
        "lambda r: r.add(f'udpin:127.0.0.1:{int(sys.argv[2]) + port}', 1.0))"
    )
    programs = [
        subprocess.Popen([sys.executable, "-c", script, str(file.path), str(port)]) for port in (2000, 3000, 4000)
    ]
    assert [each.wait(60) for each in programs] == [0, 0, 0]
    assert len(file.load().entries) == 12
