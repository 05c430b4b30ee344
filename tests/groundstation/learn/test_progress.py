"""Progress is kept in a file, and no fault of the file keeps anybody from a lesson."""

from __future__ import annotations

from pathlib import Path

from groundstation.learn.progress import Progress


def test_what_is_done_is_kept_until_it_is_forgotten(tmp_path: Path) -> None:
    file = tmp_path / "state" / "learn.json"
    Progress(file).add("2")
    Progress(file).add("1")
    before = Progress(file).stamp
    Progress(file).add("2")
    assert Progress(file).done == ("1", "2")
    assert Progress(file).stamp != before
    Progress(file).reset()
    assert (Progress(file).done, Progress(file).warning) == ((), "")


def test_a_file_that_cannot_be_used_is_named(tmp_path: Path) -> None:
    file = tmp_path / "learn.json"
    file.write_text("{")
    assert (Progress(file).done, Progress(file).warning) == ((), f"{file} is not used: it is damaged")
    in_the_way = tmp_path / "file"
    in_the_way.write_text("")
    progress = Progress(in_the_way / "learn.json")
    progress.add("1")
    assert progress.warning.startswith(f"{in_the_way / 'learn.json'} ")
