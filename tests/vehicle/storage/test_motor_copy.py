"""The copy of the motors' settings that a killed vehicle leaves for safe-stop."""

from __future__ import annotations

import logging
from pathlib import Path

import pytest

from vehicle.storage.motor_copy import default_state_folder, load_settings_copy, settings_copy

MOTORS = {"driver": "gpio", "frequency": 0.1, "bridges": [{"wiring": "two-inputs", "forward": 5, "backward": 6}]}
TABLE = {"motors": MOTORS, "accessories": {"relays": [{"driver": "gpio", "number": 0, "pin": 16}]}}


@pytest.fixture(autouse=True)
def state(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.delenv("STATE_DIRECTORY", raising=False)
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    return tmp_path / "state" / "mavhelm"


def kill(file: Path) -> None:
    """What a vehicle leaves that ends by no clean end."""
    with pytest.raises(KeyboardInterrupt), settings_copy(TABLE, file):
        raise KeyboardInterrupt


def test_while_it_drives_there_is_a_copy_and_after_the_end_none(tmp_path: Path, state: Path) -> None:
    file = tmp_path / "rover.toml"
    with settings_copy(TABLE, file):
        assert load_settings_copy(file) == TABLE
        assert load_settings_copy(tmp_path / "other.toml") is None
    assert load_settings_copy(file) is None
    assert list(state.iterdir()) == []


def test_an_exception_leaves_it_and_the_next_start_replaces_it(tmp_path: Path) -> None:
    file = tmp_path / "rover.toml"
    kill(file)
    assert load_settings_copy(file) == TABLE
    with settings_copy({"motors": {"driver": "simulated"}}, file):
        assert load_settings_copy(file) == {"motors": {"driver": "simulated"}}
    assert load_settings_copy(file) is None


def test_a_relative_name_is_the_same_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    kill(tmp_path / "rover.toml")
    monkeypatch.chdir(tmp_path)
    assert load_settings_copy(Path("rover.toml")) == TABLE


def test_a_service_has_its_own_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("STATE_DIRECTORY", f"{tmp_path / 'first'}:{tmp_path / 'second'}")
    assert default_state_folder() == tmp_path / "first"
    kill(tmp_path / "rover.toml")
    assert len(list((tmp_path / "first").iterdir())) == 1
    assert load_settings_copy(tmp_path / "rover.toml") == TABLE


def test_without_a_file_there_is_none(state: Path) -> None:
    with settings_copy(TABLE, None):
        assert not state.exists()


@pytest.mark.parametrize("text", ["", "{", "[]", "null", "{}", '{"motors": 1}', '{"motors": {"driver": 1}}', "\udcff"])
def test_a_copy_that_is_none_counts_for_nothing(tmp_path: Path, state: Path, text: str) -> None:
    kill(tmp_path / "rover.toml")
    [path] = state.iterdir()
    path.write_bytes(text.encode("utf-8", "surrogateescape"))
    assert load_settings_copy(tmp_path / "rover.toml") is None


def test_a_copy_that_cannot_be_written_is_a_warning(
    tmp_path: Path, state: Path, caplog: pytest.LogCaptureFixture
) -> None:
    state.parent.write_text("a file where a folder should be")
    with caplog.at_level(logging.WARNING), settings_copy(TABLE, tmp_path / "rover.toml"):
        [record] = caplog.records
    assert "safe-stop can use" in record.getMessage()
    assert "Not a directory" in record.getMessage()
