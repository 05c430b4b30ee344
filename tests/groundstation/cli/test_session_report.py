"""What is printed after a session."""

from __future__ import annotations

from pathlib import Path

import pytest

from dialects.modes import Mode, base_mode
from groundstation.cli.console import report_session
from tests.groundstation.ui.files.test_log_summary import heartbeat, log, speed

ARMED = heartbeat(1, autopilot=0, mode=base_mode(Mode.MANUAL, armed=True))


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("HOME", str(tmp_path))
    return tmp_path


def report(capsys: pytest.CaptureFixture[str], *logs: Path, armed: tuple[str, ...] = ()) -> str:
    report_session(armed, tuple(map(str, logs)))
    return capsys.readouterr().err


def test_what_is_left_armed_comes_first(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "a.tlog").write_bytes(b"")
    shown = report(capsys, folder / "a.tlog", armed=("Rover 1 is left ARMED in HOLD",))
    assert shown == "mavhelm: Rover 1 is left ARMED in HOLD\nmavhelm: log: ~/a.tlog\n"


def test_the_log_is_named_with_its_length_and_drive(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    driving, standing = [ARMED, speed(1.0)] * 100, [ARMED, speed(0.0)] * 300
    (folder / "a.tlog").write_bytes(log([*standing, *driving], 574.0))
    shown = report(capsys, folder / "a.tlog").removeprefix("mavhelm: log: ~/a.tlog (9:34, driven ")
    minutes, seconds = map(int, shown.removesuffix(")\n").split(":"))
    assert 60 * minutes + seconds == pytest.approx(143, abs=8)


def test_a_session_without_an_armed_vehicle_says_so(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "a.tlog").write_bytes(log([heartbeat(1, autopilot=0), speed(0.0)], 61.0, 50))
    assert report(capsys, folder / "a.tlog") == "mavhelm: log: ~/a.tlog (1:01, nothing was armed)\n"


def test_a_session_without_a_log_ends_without_a_word(capsys: pytest.CaptureFixture[str]) -> None:
    assert report(capsys) == ""
