"""Texts of parameters on this machine."""

from __future__ import annotations

from pathlib import Path

import pytest

from dialects.enums import Autopilot
from groundstation.disk.texts_folder import MAX_CACHED, TextCache, load_texts

PX4 = b'{"parameters": [{"name": "A"}]}'
APM = b'{"A": {"A": {"Description": "x"}}}'


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    made = tmp_path / "config/mavhelm"
    made.mkdir(parents=True)
    return made


def test_files_of_the_configuration_folder_fit_their_autopilot(folder: Path) -> None:
    assert load_texts().files == ()
    (folder / "parameters.json").write_bytes(PX4)
    (folder / "apm.pdef.json").write_bytes(APM)
    (folder / "apm.pdef.xml").write_bytes(b"<")
    texts = load_texts()
    assert [(file.autopilot, len(file.docs.docs)) for file in texts.files] == [
        (Autopilot.ARDUPILOT, 0), (Autopilot.ARDUPILOT, 1), (Autopilot.PX4, 1),
    ]  # fmt: skip
    assert texts.problems == ("apm.pdef.xml:1: damaged XML: unclosed token",)


def test_a_given_file_is_for_any_vehicle_and_the_only_one(folder: Path, tmp_path: Path) -> None:
    (folder / "parameters.json").write_bytes(PX4)
    (tmp_path / "mine.json").write_bytes(APM)
    [file] = load_texts(tmp_path / "mine.json").files
    assert (file.autopilot, file.docs.source) == (None, "mine.json")
    [gone] = load_texts(tmp_path / "gone").files
    assert gone.problem == f"{tmp_path}/gone: No such file or directory"


def test_the_cache_keeps_the_newest(tmp_path: Path) -> None:
    cache = TextCache(tmp_path / "new")
    assert (len(cache), cache.get(1)) == (0, None)
    for key in range(MAX_CACHED + 5):
        cache[key] = bytes([key])
    assert len(cache) == MAX_CACHED
    assert cache[MAX_CACHED + 4] == bytes([MAX_CACHED + 4])
    del cache[MAX_CACHED + 4]
    assert MAX_CACHED + 4 not in cache


def test_a_cache_that_cannot_be_written_keeps_nothing(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    cache = TextCache(tmp_path / "file")
    cache[1] = b"x"
    assert cache.get(1) is None
