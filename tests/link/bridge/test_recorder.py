"""Each session of the bridge gets a log of its own, and a folder that cannot be had is one line."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from link.bridge.recorder import RecorderError, open_recorder
from link.tlog.tlog import read_records
from tests.link.frames import heartbeat


def test_sessions_of_one_second_get_files_of_their_own(tmp_path: Path) -> None:
    folder = tmp_path / "new" / "logs"
    paths = []
    for number in range(3):
        path, recorder = open_recorder(folder)
        recorder.add(1.0, [heartbeat(number)])
        recorder.close()
        paths.append(path)
    assert len(set(paths)) == 3
    assert sorted(folder.iterdir()) == sorted(paths)
    for number, path in enumerate(paths):
        assert [record.raw for record in read_records(path.read_bytes())] == [heartbeat(number)]


@pytest.mark.parametrize("name", ["taken", "taken/logs"])
def test_a_file_of_that_name_is_named(tmp_path: Path, name: str) -> None:
    (tmp_path / "taken").write_text("mine")
    with pytest.raises(RecorderError) as caught:
        open_recorder(tmp_path / name)
    assert str(caught.value) == f"--tlog {tmp_path / name}: a file of that name exists; name a directory"
    assert (tmp_path / "taken").read_text() == "mine"


def test_another_error_of_the_system_is_named() -> None:
    with pytest.raises(RecorderError) as caught:
        open_recorder(Path("/proc/none"))
    assert str(caught.value) == f"--tlog /proc/none: {os.strerror(2)}"
