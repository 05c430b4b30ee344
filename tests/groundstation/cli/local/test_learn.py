"""`mavhelm learn` without a lesson: what is done, and files of teachers that cannot be used."""

from __future__ import annotations

from pathlib import Path

import pytest

from groundstation.cli.local.learn import run
from groundstation.learn.progress import Progress
from tests.groundstation.learn.test_lesson_file import GOOD


def test_what_is_done_is_listed_and_forgotten(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    Progress().add("2")
    assert run(["list"]) == 0
    listed = capsys.readouterr().out.splitlines()
    assert [line.split()[:2] for line in listed[:3]] == [["1", "-"], ["2", "done"], ["3", "-"]]
    assert len(listed) == 10
    assert run(["reset"]) == 0
    assert capsys.readouterr().err == "no lesson is done any more\n"
    assert Progress().done == ()
    run(["list"])
    assert "done" not in capsys.readouterr().out


def test_what_is_no_lesson_is_one_line_with_code_2(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "mine.toml"
    file.write_text(GOOD.replace('"drive"', '"cockpit"', 1))
    for word, says in (
        (str(file), "mine.toml:2: screen: there is no screen 'cockpit'"),
        ("77", "77"),
        ("x.toml", "x.toml"),
    ):
        assert run([word]) == 2
        error = capsys.readouterr().err
        assert says in error
        assert len(error.splitlines()) == 1
