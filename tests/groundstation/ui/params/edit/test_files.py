"""Favourites, and files that are opened and saved."""

from __future__ import annotations

from pathlib import Path

import pytest

from groundstation.ui.params.edit.files import MAX_SIZE, SaveChoice, parse_save, read_file
from groundstation.ui.params.favourites import Favourites

HERE = Path("/here")


@pytest.mark.parametrize(
    ("text", "choice"),
    [
        ("a.param", SaveChoice(HERE / "a.param")), (" a b.parm changed ", SaveChoice(HERE / "a b.parm", "changed")),
        ("a.params", SaveChoice(HERE / "a.params", "all", "qgc")),
        ("/x/a.params group mp", SaveChoice(Path("/x/a.params"), "group", "mp")),
        ("a.param qgc changed", SaveChoice(HERE / "a.param", "changed", "qgc")), ("all", SaveChoice(HERE / "all")),
        ("", "no file is named"),
    ],
)  # fmt: skip
def test_what_to_save(text: str, choice: SaveChoice | str) -> None:
    assert parse_save(text, HERE) == choice


def test_files_that_cannot_be_read(tmp_path: Path) -> None:
    (tmp_path / "binary").write_bytes(b"\xff\xfe")
    (tmp_path / "large").write_bytes(b" " * (MAX_SIZE + 1))
    (tmp_path / "good.param").write_text("A 1\n")
    assert read_file("good.param", tmp_path) == ("good.param", "A 1\n")
    assert read_file("no", tmp_path) == f"{tmp_path}/no: there is no such file"
    assert read_file(".", tmp_path) == f"{tmp_path}: there is no such file"
    assert read_file("binary", tmp_path) == f"{tmp_path}/binary: this is not a text file"
    assert read_file("large", tmp_path) == f"{tmp_path}/large: more than {MAX_SIZE} bytes: this is not a parameter file"


def test_favourites_outlive_the_program(tmp_path: Path) -> None:
    first = Favourites(tmp_path / "new")
    assert first.toggle("ardupilot", "FS_ACTION") is None
    assert first.toggle("ardupilot", "WP_SPEED") is None
    assert first.toggle("ardupilot", "WP_SPEED") is None
    again = Favourites(tmp_path / "new")
    assert (again.get("ardupilot"), again.get("px4")) == (frozenset({"FS_ACTION"}), frozenset())
    assert again.warning == ""


@pytest.mark.parametrize("data", [b"\xff\xfe", b"A\x1b[2J\n", b"A\n" * 2000, b"\n\n"])
def test_a_damaged_file_is_ignored_with_a_warning(tmp_path: Path, data: bytes) -> None:
    (tmp_path / "favourite-params-px4.txt").write_bytes(data)
    favourites = Favourites(tmp_path)
    assert favourites.get("px4") == frozenset()
    assert favourites.warning.startswith(f"favourites ignored: {tmp_path}/favourite-params-px4.txt: not a ")


def test_a_folder_that_cannot_be_written_is_said(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    problem = Favourites(tmp_path / "file").toggle("px4", "A")
    assert problem is not None
    assert problem.startswith("favourites are not saved: ")
